"""Asks and hears in the types of system_modes and our own, and prints what came as JSON.

Runs as a process of its own, whose environment names the packages that were built.
"""

import json
import time
from collections.abc import Callable
from importlib import import_module
from typing import Any

WITHIN_S = 30.0
STATES = 40


class Heard:
    """What came, by topic."""

    def __init__(self) -> None:
        self.modes: list[tuple[str, str]] = []
        self.states: list[tuple[float, int, int]] = []

    def mode(self, message: Any) -> None:  # noqa: ANN401
        """Note a ModeEvent."""
        self.modes.append((message.start_mode.label, message.goal_mode.label))

    def state(self, message: Any) -> None:  # noqa: ANN401
        """Note a SystemState."""
        stamp = message.header.stamp
        self.states.append((stamp.sec + stamp.nanosec / 1e9, message.state, message.error_code))


def main() -> None:
    """Bring the robot into a mode, press its emergency stop, and say what was heard."""
    rclpy: Any = import_module("rclpy")
    modes, own = import_module("system_modes_msgs.msg"), import_module("pilothouse_msgs.msg")
    services = import_module("system_modes_msgs.srv")
    rclpy.init()
    node = rclpy.create_node("native_client")
    heard = Heard()

    def until(is_it: Callable[[], bool]) -> None:
        end = time.monotonic() + WITHIN_S
        while not is_it():
            assert time.monotonic() < end, (heard.modes, heard.states[-3:])
            rclpy.spin_once(node, timeout_sec=0.1)

    def call(service: str, kind: Any, **fields: str) -> Any:  # noqa: ANN401
        client = node.create_client(kind, service)
        until(client.service_is_ready)
        future = client.call_async(kind.Request(**fields))
        until(future.done)
        return future.result()

    hears_modes = node.create_subscription(
        modes.ModeEvent, "/actuation/mode_event", heard.mode, 100
    )
    hears_states = node.create_subscription(own.SystemState, "/system_state", heard.state, 100)
    estop = node.create_publisher(own.EmergencyStop, "/estop", 10)
    until(lambda: hears_modes.get_publisher_count() + hears_states.get_publisher_count() == 2)
    until(lambda: estop.get_subscription_count() > 0)

    success = call("/actuation/change_mode", services.ChangeMode, mode_name="PERFORMANCE").success
    until(lambda: len(heard.states) >= STATES)
    pressed = len(heard.states)
    estop.publish(own.EmergencyStop(enabled=True))
    until(lambda: bool(heard.states[-1][2] & own.SystemState.ERROR_ESTOP))
    print(
        json.dumps(
            {
                "success": success,
                "mode": call("/actuation/get_mode", services.GetMode).current_mode,
                "modes": call(
                    "/actuation/get_available_modes", services.GetAvailableModes
                ).available_modes,
                "heard": heard.modes,
                "states_before": heard.states[:pressed],
                "state_at_last": heard.states[-1][1:],
            }
        )
    )
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
