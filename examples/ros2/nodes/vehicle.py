"""A vehicle without hardware: a kinematic model that listens to drive commands, and is where it is.

Subscribes to `/cmd_vel` (`geometry_msgs/msg/Twist`) and publishes `/odom`
(`nav_msgs/msg/Odometry`) of the centre of the rear axle, 50 times a second. Without a command for
`command_timeout` it brakes, as every real base must: that is what stops it when a computer dies.

Run it: `python3 vehicle.py`, or beside a path: `python3 vehicle.py --ros-args -p y:=-2.0`
"""

import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

RATE_HZ = 50.0


class Vehicle(Node):
    """Follows the newest command, as far as it can accelerate and brake."""

    def __init__(self) -> None:
        super().__init__("vehicle")
        # Where it begins, in m and rad.
        self._x = self.declare_parameter("x", 0.0).value
        self._y = self.declare_parameter("y", 0.0).value
        self._yaw = self.declare_parameter("yaw", 0.0).value
        # In m/s2 and s; both may be changed while it drives.
        self.declare_parameter("acceleration", 2.0)
        self.declare_parameter("command_timeout", 0.5)
        # False: it falls silent, as with a receiver that has no fix.
        self.declare_parameter("odometry", True)
        self._speed, self._curvature = 0.0, 0.0
        self._wanted = 0.0
        self._heard = self._moved = self._now()
        self._odometry = self.create_publisher(Odometry, "/odom", 10)
        self.create_subscription(Twist, "/cmd_vel", self._take, 1)
        self.create_timer(1 / RATE_HZ, self._move)

    def _now(self) -> float:
        return float(self.get_clock().now().nanoseconds / 1e9)

    def _take(self, command: Twist) -> None:
        self._heard, self._wanted = self._now(), command.linear.x
        if command.linear.x != 0.0:
            # A Twist has no steering angle: at speed 0 the wheels stay as they are.
            self._curvature = command.angular.z / command.linear.x

    def _move(self) -> None:
        """Drive for one period, and tell where that led."""
        now = self._now()
        period, self._moved = now - self._moved, now
        is_late = now - self._heard > self.get_parameter("command_timeout").value
        wanted = 0.0 if is_late else self._wanted
        most = self.get_parameter("acceleration").value * period
        self._speed += min(max(wanted - self._speed, -most), most)
        way = self._speed * period
        # Along the arc: by its chord, whose direction is that in its middle.
        middle = self._yaw + self._curvature * way / 2
        self._x += way * math.cos(middle)
        self._y += way * math.sin(middle)
        self._yaw += self._curvature * way
        if self.get_parameter("odometry").value:
            self._odometry.publish(self._where())

    def _where(self) -> Odometry:
        told = Odometry()
        told.header.stamp = self.get_clock().now().to_msg()
        told.header.frame_id, told.child_frame_id = "odom", "base_footprint"
        told.pose.pose.position.x = self._x
        told.pose.pose.position.y = self._y
        told.pose.pose.orientation.z = math.sin(self._yaw / 2)
        told.pose.pose.orientation.w = math.cos(self._yaw / 2)
        told.twist.twist.linear.x = self._speed
        told.twist.twist.angular.z = self._speed * self._curvature
        return told


def main() -> None:
    """Run the node until Ctrl-C."""
    rclpy.init()
    node = Vehicle()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
