"""Three computers in networks of their own, whose links are cut and lose packets."""

import time
from collections.abc import Iterator

import pytest

from tests.support.namespaces import why_not
from tests.support.robot_in_networks import (
    OFFLINE_AFTER_S,
    Robot,
    actual,
    is_stopped,
    robot_in_networks,
    until,
)

pytest.importorskip("zenoh", reason="the extra `link` is not installed")
_WHY_NOT = why_not()
pytestmark = [
    pytest.mark.timeout(240),
    pytest.mark.skipif(_WHY_NOT is not None, reason=str(_WHY_NOT)),
]

LATE_WITHIN_S, LOST_WITHIN_S = 0.7, 1.8
SEEN_S = 0.3
"""What a busy machine and the asking take on top."""
LINK = '{listen: ["tcp/0.0.0.0:7470"], connect: ["tcp/ADDRESS:7470"]}'


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Robot]:
    folder = tmp_path_factory.mktemp("robot")
    with robot_in_networks(folder, LINK, "--insecure-link") as robot:
        yield robot


@pytest.fixture
def robot(running: Robot) -> Robot:
    """The robot, whole and in PERFORMANCE."""
    running.network.heal()
    until(running.are_connected)
    running.supervisor.ask("POST", "/systems/actuation/mode?wait=20", {"mode": "PERFORMANCE"})
    assert actual(running.supervisor, "systems/actuation") == ("active", "PERFORMANCE")
    return running


def test_a_cut_off_device_is_lost_in_time_does_what_it_is_to_and_is_adopted(robot: Robot) -> None:
    supervisor, base = robot.supervisor, robot.base
    before, before_base = robot.newest(supervisor), robot.newest(base)

    # On a busy machine the commands that cut it take some time: it may be cut before they end.
    begin = time.monotonic()
    robot.network.cut("supervisor", "base")
    cut_at = time.monotonic()
    late_s = until(lambda: robot.states()["base"] != "connected")
    until(lambda: robot.states()["base"] == "lost")
    lost_s = time.monotonic() - cut_at
    system = supervisor.ask("GET", "/systems/actuation")
    until(lambda: actual(base, "nodes/drive_base") == ("inactive", None))
    alone_s = time.monotonic() - cut_at

    print(f"late {late_s:.2f} s, lost {lost_s:.2f} s, inactive {alone_s:.2f} s after the cut")
    assert late_s < LATE_WITHIN_S + SEEN_S
    assert lost_s < LOST_WITHIN_S + SEEN_S
    assert alone_s + (cut_at - begin) > OFFLINE_AFTER_S - SEEN_S
    assert alone_s < OFFLINE_AFTER_S + 1.0
    assert (system["actual"]["state"], system["reachable"]) == ("unknown", False)
    assert "device base" in system["actual"]["reason"]
    assert robot.states()["arm"] == "connected"
    steps = robot.events(base, before_base, "change.step_started")
    assert [(step["node"], step["action"]) for step in steps] == [("drive_base", "deactivate")]

    robot.network.heal()
    until(robot.are_connected)
    time.sleep(2.0)  # It stays so: that can only be waited for.

    assert actual(supervisor, "nodes/drive_base") == ("inactive", None)
    assert actual(base, "nodes/drive_base") == ("inactive", None)
    changes = robot.events(supervisor, before, "part.actual_changed")
    of_base = [each["actual"] for each in changes if each["part"] == "drive_base"]
    assert of_base == ["unknown", "inactive"]
    assert len(robot.events(supervisor, before, "device.connected")) == 1
    assert len(robot.events(supervisor, before, "device.lost")) == 1
    assert supervisor.ask("GET", "/nodes/drive_base")["target"] == {
        "state": "active",
        "mode": "FAST",
    }


def test_a_command_of_before_a_cut_is_never_carried_out(robot: Robot) -> None:
    before = robot.newest(robot.arm)

    robot.network.cut("supervisor", "arm")
    # It is still connected, so this is sent; it waits in the buffers of the network.
    change = robot.supervisor.ask("POST", "/nodes/manipulator/mode", {"mode": "WEAK"})
    assert change["status"] == "running"
    until(lambda: robot.states()["arm"] == "lost")
    robot.network.heal()
    until(robot.are_connected)
    time.sleep(2.0)  # Nothing comes: that can only be waited for.

    assert actual(robot.arm, "nodes/manipulator") == ("active", "STRONG")
    assert robot.events(robot.arm, before, "change.step_started") == []
    assert robot.supervisor.ask("GET", f"/changes/{change['id']}")["status"] in (
        "failed",
        "timed_out",
    )


@pytest.mark.parametrize(("sender", "receiver"), [("supervisor", "base"), ("base", "supervisor")])
def test_a_link_that_is_cut_one_way_is_cut(robot: Robot, sender: str, receiver: str) -> None:
    robot.network.cut_towards(sender, receiver)
    lost_s = until(lambda: robot.states()["base"] == "lost")
    until(lambda: actual(robot.base, "nodes/drive_base") == ("inactive", None))

    assert lost_s < LOST_WITHIN_S + SEEN_S
    robot.network.heal()
    until(robot.are_connected)
    assert actual(robot.supervisor, "nodes/drive_base") == ("inactive", None)


def test_a_stop_at_a_device_that_is_cut_off_stops_the_robot_once_it_is_back(robot: Robot) -> None:
    robot.network.cut("supervisor", "arm")
    robot.network.cut("base", "arm")
    until(lambda: robot.states()["arm"] == "lost")
    robot.arm.ask("PUT", "/emergency_stop", {"engaged": True, "reason": "a hand in the arm"})
    robot.supervisor.ask("PUT", "/emergency_stop", {"engaged": True, "reason": "a test"})
    robot.supervisor.ask("PUT", "/emergency_stop", {"engaged": False})
    assert not is_stopped(robot.supervisor)

    robot.network.heal()
    until(lambda: is_stopped(robot.supervisor))
    until(lambda: is_stopped(robot.base))
    # A stop is taken at once; a release only counts on a connection.
    until(robot.are_connected)

    robot.supervisor.ask("PUT", "/emergency_stop", {"engaged": False})
    hosts = (robot.supervisor, robot.base, robot.arm)
    until(lambda: not any(is_stopped(host) for host in hosts))


def test_a_link_that_loses_packets_is_whole_again_once_it_loses_none(robot: Robot) -> None:
    for one, other in (("supervisor", "base"), ("base", "supervisor")):
        robot.network.lose(one, other, 0.3)
    time.sleep(10.0)
    robot.network.heal()
    healed_s = until(lambda: robot.are_connected() and _agree(robot))

    print(f"whole {healed_s:.2f} s after the last packet was lost")


def _agree(robot: Robot) -> bool:
    node = "nodes/drive_base"
    return actual(robot.supervisor, node) == actual(robot.base, node)
