"""Lets a vehicle follow its controller, unless Pilothouse says stop: what twist_mux does.

Subscribes to `/controller_cmd` and `/stop_cmd` and publishes `/cmd_vel`, all of them
`geometry_msgs/msg/Twist`. What comes on `/stop_cmd` goes before for half a second; Pilothouse sends
there only while the vehicle must stop. Run it: `python3 multiplexer.py`
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

VALID_FOR_S = 0.5


class Multiplexer(Node):
    """Passes on the commands of whoever goes before."""

    def __init__(self) -> None:
        super().__init__("multiplexer")
        self._stopped_at = float("-inf")
        self._out = self.create_publisher(Twist, "/cmd_vel", 1)
        self.create_subscription(Twist, "/stop_cmd", self._stop, 1)
        self.create_subscription(Twist, "/controller_cmd", self._drive, 1)

    def _now(self) -> float:
        return float(self.get_clock().now().nanoseconds / 1e9)

    def _stop(self, command: Twist) -> None:
        self._stopped_at = self._now()
        self._out.publish(command)

    def _drive(self, command: Twist) -> None:
        if self._now() - self._stopped_at > VALID_FOR_S:
            self._out.publish(command)


def main() -> None:
    """Run the node until Ctrl-C."""
    rclpy.init()
    node = Multiplexer()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
