"""Begins tasks over ROS in the types of pilothouse_msgs, and prints what came as JSON.

Runs as a process of its own, whose environment names the packages that were built. It hears the
states of robot and task for as long as it is told, and calls services meanwhile.

    task_client.py SECONDS [[SERVICE, REQUEST], ...]
"""

import json
import sys
import time
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

WITHIN_S = 30.0
KINDS = {"/serve_waypoints": "StartTask", "/drive_waypoints": "DriveWaypoints"}


class Client:
    """A node that calls and hears."""

    def __init__(self) -> None:
        self._rclpy: Any = import_module("rclpy")
        self._messages = import_module("pilothouse_msgs.msg")
        self._services = import_module("pilothouse_msgs.srv")
        self._empty = import_module("std_srvs.srv").Empty
        self._rclpy.init()
        self._node = self._rclpy.create_node("task_client")
        self.heard: dict[str, list[tuple[int, int, int]]] = {"state": [], "task": []}
        """By topic: when it was stamped and when it came, ns since 1970, and its value."""

    def hear(self) -> None:
        """Hear the states of robot and task."""
        kinds = self._messages.SystemState, self._messages.TaskStatus
        state = self._node.create_subscription(kinds[0], "/system_state", self._state, 100)
        task = self._node.create_subscription(kinds[1], "/task_planner_status", self._task, 100)
        self.until(lambda: state.get_publisher_count() == task.get_publisher_count() == 1)

    def call(self, service: str, request: Mapping[str, Any]) -> dict[str, Any]:
        """Call a service; return its response."""
        kind = getattr(self._services, KINDS[service]) if service in KINDS else self._empty
        given = dict(request)
        if "waypoints" in given:
            waypoint = self._messages.Waypoint
            given["waypoints"] = [
                waypoint(x_m=x, y_m=y, yaw_rad=w) for x, y, w in given["waypoints"]
            ]
        client = self._node.create_client(kind, service)
        self.until(client.service_is_ready)
        future = client.call_async(kind.Request(**given))
        self.until(future.done)
        response = future.result()
        return {name: getattr(response, name) for name in response.get_fields_and_field_types()}

    def until(self, is_it: Callable[[], bool], within_s: float = WITHIN_S) -> None:
        """Hear messages until something is so."""
        end = time.monotonic() + within_s
        while not is_it():
            assert time.monotonic() < end, "it took too long"
            self._rclpy.spin_once(self._node, timeout_sec=0.1)

    def _state(self, message: Any, info: Mapping[str, int]) -> None:  # noqa: ANN401
        self._note("state", message, info, message.state)

    def _task(self, message: Any, info: Mapping[str, int]) -> None:  # noqa: ANN401
        self._note("task", message, info, message.status)

    def _note(self, topic: str, message: Any, info: Mapping[str, int], value: int) -> None:  # noqa: ANN401
        stamp = message.header.stamp
        # As the middleware notes it: a callback waits for the one before it.
        came = info["received_timestamp"]
        self.heard[topic].append((stamp.sec * 10**9 + stamp.nanosec, came, value))


def main() -> None:
    """Call, hear, and print."""
    hear_s, calls = float(sys.argv[1]), json.loads(sys.argv[2]) if sys.argv[2:] else []
    client = Client()
    client.hear()
    responses = []
    for service, request in calls:
        responses.append(client.call(service, request))
        # Until the state after the call was heard.
        before = len(client.heard["task"])
        client.until(lambda before=before: len(client.heard["task"]) > before + 1)  # type: ignore[misc]
    end = time.monotonic() + hear_s
    client.until(lambda: time.monotonic() > end, hear_s + WITHIN_S)
    print(json.dumps({"responses": responses, "heard": client.heard}))


if __name__ == "__main__":
    main()
