"""Three computers with networks of their own, and the robot that they are."""

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from tests.support.namespaces import Host, Network, started
from tests.support.process import COMMAND
from tests.support.shared import PROJECT

OFFLINE_AFTER_S = 2.0
START_WITHIN_S = 90.0
PATIENCE_S = 20.0
MODEL = PROJECT / "service" / "example" / "actuation.yaml"
ROBOT = f"""\
name: lawn
link: LINK
devices:
  base:
    parts: [drive_base]
    offline: {{after_s: {OFFLINE_AFTER_S}, target: {{drive_base: inactive}}}}
  arm: {{parts: [manipulator]}}
nodes:
  drive_base: {{deactivate_s: 0.1, activate_s: 0.1, configure_s: 0.1, set_parameters_s: 0.1}}
"""


class Robot:
    """The robot: its network, and its computers."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.supervisor, self.base, self.arm = (
            network.hosts[name] for name in ("supervisor", "base", "arm")
        )

    def states(self) -> dict[str, str]:
        """Return how the supervisor's connection to each device is."""
        return {
            item["device"]: item["state"]
            for item in self.supervisor.ask("GET", "/devices")["items"]
        }

    def are_connected(self) -> bool:
        """Tell whether the supervisor deals with both devices."""
        return set(self.states().values()) == {"connected"}

    def newest(self, host: Host) -> int:
        """Return the id of the newest event."""
        return int(host.ask("GET", "/events?limit=1&before=1000000000")["items"][-1]["id"])

    def events(self, host: Host, after: int, kind: str) -> list[dict[str, Any]]:
        """Return the data of the events of a kind since one."""
        path = f"/events?after={after}&kind={kind}&limit=1000"
        return [event["data"] for event in host.ask("GET", path)["items"]]


@contextmanager
def robot_in_networks(folder: Path, link: str, *more: str) -> Iterator[Robot]:
    """Run the robot, connected, as long as the context lasts.

    Args:
        folder: For its files.
        link: The block `link` of its robot file; `ADDRESS` stands for that of the supervisor.
        more: Options of each computer.
    """
    with Network(["supervisor", "base", "arm"]) as network, ExitStack() as stack:
        robot = Robot(network)
        file = folder / "robot.yaml"
        file.write_text(ROBOT.replace("LINK", link).replace("ADDRESS", robot.supervisor.address))
        options = (str(MODEL), "--robot", str(file), "--data", ":memory:", *more)
        stack.enter_context(started(robot.supervisor, *COMMAND, "serve", *options))
        stack.enter_context(started(robot.base, *COMMAND, "device", "base", *options))
        stack.enter_context(started(robot.arm, *COMMAND, "device", "arm", *options))
        until(lambda: _answers(robot) and robot.are_connected(), START_WITHIN_S)
        yield robot


def until(condition: Callable[[], bool], within_s: float = PATIENCE_S) -> float:
    """Wait until something holds; return how many seconds that took."""
    begun = time.monotonic()
    while not condition():
        assert time.monotonic() - begun < within_s, f"not within {within_s} s"
        time.sleep(0.02)
    return time.monotonic() - begun


def actual(host: Host, part: str) -> tuple[str, str | None]:
    """Return the actual state and mode of a part, as a computer knows it."""
    found = host.ask("GET", f"/{part}")["actual"]
    return found["state"], found["mode"]


def is_stopped(host: Host) -> bool:
    """Tell whether the robot is stopped, as a computer knows it."""
    return bool(host.ask("GET", "/emergency_stop")["engaged"])


def _answers(robot: Robot) -> bool:
    try:
        robot.states()
        robot.base.ask("GET", "/livez")
        robot.arm.ask("GET", "/livez")
    except OSError:
        return False
    return True
