"""A controller for paths along the x axis, an action server in a process of its own.

python controller.py MANNERS

MANNERS: `honest`, `ignores` (that its goal is taken back), `lies` (says that it passed waypoints
far ahead), `arrives` (says after 5 m that it reached the end, and drives on).
"""

import sys
import threading
import time
from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from pilothouse_msgs.action import NavigateWaypoints
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

PERIOD_S = 0.05
LIES_AT_M = ARRIVES_AT_M = 5.0
FAR = 50


class Controller(Node):
    """Drives straight on, at the speed of the goal."""

    def __init__(self, manners: str) -> None:
        super().__init__("controller")
        self._manners = manners
        self._x = 0.0
        self._ended = threading.Event()
        group = ReentrantCallbackGroup()
        self._commands = self.create_publisher(Twist, "/controller_cmd", 1)
        self.create_subscription(Odometry, "/odom", self._hear, 1, callback_group=group)
        self._server = ActionServer(
            self,
            NavigateWaypoints,
            "/navigate_waypoints",
            self._execute,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
            callback_group=group,
        )

    def _hear(self, odometry: Odometry) -> None:
        self._x = odometry.pose.pose.position.x

    def _execute(self, handle: Any) -> NavigateWaypoints.Result:  # noqa: ANN401  # rclpy's
        goal = handle.request
        xs = [waypoint.x_m for waypoint in goal.waypoints]
        index = goal.start_index
        while self._x < xs[-1] - 0.05:
            if handle.is_cancel_requested and self._manners != "ignores":
                self._drive(0.0)
                handle.canceled()
                return NavigateWaypoints.Result(success=False, message="")
            while index < len(xs) - 1 and xs[index] <= self._x:
                index += 1
            self._drive(min(goal.speed_mps, 0.2 + (xs[-1] - self._x)))
            is_lie = self._manners == "lies" and self._x > LIES_AT_M
            told = NavigateWaypoints.Feedback(
                target_index=min(index + FAR * is_lie, len(xs) - 1),
                progress=max(min(self._x / xs[-1], 1.0), 0.0),
            )
            handle.publish_feedback(told)
            if self._manners == "arrives" and self._x > ARRIVES_AT_M:
                threading.Thread(target=self._drive_on, daemon=True).start()
                break
            time.sleep(PERIOD_S)
        else:
            self._drive(0.0)
        handle.succeed()
        return NavigateWaypoints.Result(success=True, message="")

    def _drive_on(self) -> None:
        while True:
            self._drive(1.0)
            time.sleep(PERIOD_S)

    def _drive(self, speed_mps: float) -> None:
        command = Twist()
        command.linear.x = speed_mps
        self._commands.publish(command)


def main() -> None:
    """Run until it is ended."""
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Controller(sys.argv[1]))
    executor.spin()


if __name__ == "__main__":
    main()
