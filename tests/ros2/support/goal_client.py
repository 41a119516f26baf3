"""A client of the action `NavigateWaypoints`, in a process of its own.

python goal_client.py ACTION

Each line on standard input is JSON: `{"send": NAME, "waypoints": [[x, y, yaw], ...],
"start_index": ..., "speed_mps": ...}` or `{"cancel": NAME}`. Each line on standard output is JSON:
`{"ready": true}` once there is a server, then what is told of a goal, with its `goal`: `accepted`,
`feedback` (target index and progress), `canceling` (the server accepts the cancel), or its end:
`status`, `success` and `message`.
"""

import json
import os
import sys
import threading
from functools import partial
from typing import Any

import rclpy
from action_msgs.msg import GoalStatus
from pilothouse_msgs.action import NavigateWaypoints
from pilothouse_msgs.msg import Waypoint
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor

STATUS = {
    GoalStatus.STATUS_SUCCEEDED: "succeeded",
    GoalStatus.STATUS_ABORTED: "aborted",
    GoalStatus.STATUS_CANCELED: "canceled",
}


def tell(**told: object) -> None:
    """Print a line."""
    print(json.dumps(told), flush=True)


class Goals:
    """The goals of one client, by name."""

    def __init__(self, client: Any) -> None:  # noqa: ANN401  # rclpy's
        self._client = client
        self._handles: dict[str, Any] = {}

    def do(self, order: dict[str, Any]) -> None:
        """Do what a line says."""
        if "cancel" in order:
            name = order["cancel"]
            self._handles[name].cancel_goal_async().add_done_callback(
                lambda done: tell(goal=name, canceling=len(done.result().goals_canceling) == 1)
            )
            return
        name, goal = order["send"], NavigateWaypoints.Goal()
        goal.waypoints = [Waypoint(x_m=x, y_m=y, yaw_rad=yaw) for x, y, yaw in order["waypoints"]]
        goal.start_index, goal.speed_mps = order["start_index"], order["speed_mps"]
        sent = self._client.send_goal_async(goal, feedback_callback=partial(self._feedback, name))
        sent.add_done_callback(partial(self._answered, name))

    def _feedback(self, name: str, message: Any) -> None:  # noqa: ANN401
        told = message.feedback
        tell(goal=name, feedback=[told.target_index, told.progress])

    def _answered(self, name: str, done: Any) -> None:  # noqa: ANN401
        handle = done.result()
        if handle.accepted:
            self._handles[name] = handle
            handle.get_result_async().add_done_callback(partial(self._ended, name))
        tell(goal=name, accepted=handle.accepted)

    def _ended(self, name: str, done: Any) -> None:  # noqa: ANN401
        ended = done.result()
        result = ended.result
        tell(
            goal=name,
            status=STATUS.get(ended.status, str(ended.status)),
            success=result.success,
            message=result.message,
        )


def main() -> None:
    """Serve standard input until it ends."""
    rclpy.init()
    node = rclpy.create_node("goal_client")
    client = ActionClient(node, NavigateWaypoints, sys.argv[1])
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()
    client.wait_for_server()
    tell(ready=True)
    goals = Goals(client)
    for line in sys.stdin:
        executor.create_task(goals.do, json.loads(line))
    # The thread of the executor would abort the interpreter.
    os._exit(0)


if __name__ == "__main__":
    main()
