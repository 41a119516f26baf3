"""`pilothouse tracker`, with a graph in memory in the place of ROS 2."""

import asyncio
import signal
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from api.serving.failures import FAILED, MISUSED, SUCCEEDED
from api.serving.tracking import TrackerOptions, settings_of, track
from domain.timebase import seconds
from service.files.ros2_block import CommandBlock, CommandType, OdometryBlock
from service.ros.graph.graph import Lane
from service.ros.tracker_node import NAVIGATE_WAYPOINTS
from tests.support.manual_clock import ManualClock
from tests.support.ros_graph import FakeGraph, FakeRosNode

LINK = "service.ros.graph.link"
TWIST: CommandType = "geometry_msgs/msg/Twist"
ACKERMANN: CommandType = "ackermann_msgs/msg/AckermannDriveStamped"
ODOMETRY = {
    "pose": {
        "pose": {
            "position": {"x": 0.0, "y": 0.0, "z": 0.0},
            "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
        }
    },
    "twist": {"twist": {"linear": {"x": 0.0}, "angular": {"z": 0.0}}},
}
GIVEN = TrackerOptions("stanley", "/navigate_waypoints")
ROBOT = f"""\
vehicle: {{wheelbase_m: 0.5, plant: {{braking_mps2: 3.0}}}}
driving: {{pose_stale_after_s: 0.2, no_progress_for_s: 7}}
ros2:
  odometry: {{topic: /gem/odometry}}
  command: {{topic: /gem/drive, type: {ACKERMANN}}}
"""


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    path = tmp_path / "robot.yaml"
    path.write_text(ROBOT)
    return path


def use(graph: FakeGraph, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, LINK, SimpleNamespace(RosLink=lambda: graph))


def when_offered(graph: FakeGraph, monkeypatch: pytest.MonkeyPatch, do: Callable[[], None]) -> None:
    """Do something once the action is offered to clients; a vehicle says where it is."""
    offer, subscribe = FakeRosNode.serve_action, FakeRosNode.subscribe

    def offered(self: FakeRosNode, *given: object) -> None:
        offer(self, *given)  # type: ignore[arg-type]
        do()

    def subscribed(self: FakeRosNode, topic: str, *given: object) -> None:
        subscribe(self, topic, *given)  # type: ignore[arg-type]
        if topic == "/odom":
            asyncio.get_running_loop().call_soon(graph.publish, topic, ODOMETRY)

    monkeypatch.setattr(FakeRosNode, "serve_action", offered)
    monkeypatch.setattr(FakeRosNode, "subscribe", subscribed)


# --- what is driven ------------------------------------------------------------------------------


def test_without_a_robot_file_the_usual_topics_are_used() -> None:
    settings = settings_of(GIVEN)

    assert settings.controller == "stanley"
    assert settings.topics.odometry == OdometryBlock(topic="/odom")
    assert settings.topics.command == CommandBlock(topic="/cmd_vel", type=TWIST)
    assert settings.limits.wheelbase_m == 1.75


def test_the_robot_file_says_what_is_driven_and_how(robot: Path) -> None:
    settings = settings_of(replace(GIVEN, robot=robot))

    assert settings.topics.odometry == OdometryBlock(topic="/gem/odometry")
    assert settings.topics.command == CommandBlock(topic="/gem/drive", type=ACKERMANN)
    assert settings.limits.wheelbase_m == 0.5
    assert settings.limits.braking_mps2 == 3.0
    assert settings.tasks.pose_stale_after == seconds(0.2)
    assert settings.navigation.no_progress_for == seconds(7)


def test_options_go_before_the_robot_file(robot: Path) -> None:
    settings = settings_of(
        replace(GIVEN, robot=robot, odometry="/odom", command="/cmd_vel", command_type=TWIST)
    )

    assert settings.topics.odometry == OdometryBlock(topic="/odom")
    assert settings.topics.command == CommandBlock(topic="/cmd_vel", type=TWIST)


# --- how it ends ---------------------------------------------------------------------------------


def test_it_runs_until_a_signal_and_says_what_it_does(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    graph = FakeGraph(ManualClock())
    use(graph, monkeypatch)
    when_offered(graph, monkeypatch, lambda: signal.raise_signal(signal.SIGTERM))

    assert track(GIVEN) == SUCCEEDED

    said = capsys.readouterr().out
    assert "stanley drives the goals of /navigate_waypoints (ROS 2 domain 0)" in said
    assert f"commands  /cmd_vel  {TWIST}" in said
    assert graph.nodes["tracker"] is Lane.GATEWAY
    assert graph.closed


def test_without_ros_2_it_ends_with_what_to_do_about_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, LINK, None)

    assert track(GIVEN) == MISUSED

    assert "setup.bash" in capsys.readouterr().err


def test_without_the_messages_it_ends_with_what_to_do_about_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    graph = FakeGraph(ManualClock(), missing=(NAVIGATE_WAYPOINTS,))
    use(graph, monkeypatch)

    assert track(GIVEN) == FAILED

    told = capsys.readouterr().err
    assert "install its package (pilothouse_msgs)" in told
    assert "Traceback" not in told
    assert graph.closed


def test_it_ends_when_the_connection_to_ros_2_fails(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    graph = FakeGraph(ManualClock())
    use(graph, monkeypatch)
    when_offered(graph, monkeypatch, graph.fail)

    assert track(GIVEN) == FAILED

    [record] = [each for each in caplog.records if each.levelname == "CRITICAL"]
    assert record.getMessage() == "the graph failed"
    assert record.exc_info is None


def test_a_robot_file_that_is_not_there_is_named(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert track(replace(GIVEN, robot=tmp_path / "none.yaml")) == MISUSED

    assert "none.yaml" in capsys.readouterr().err


def test_what_is_wrong_in_a_robot_file_is_told_with_its_line(
    robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot.write_text("driving: {speed: 3}\n")

    assert track(replace(GIVEN, robot=robot)) == FAILED

    assert f"{robot}:1:" in capsys.readouterr().err


def test_what_is_wrong_in_a_model_is_told_with_its_line(
    robot: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = tmp_path / "model.yaml"
    model.write_text("base: {modes: 3}\n")

    assert track(replace(GIVEN, model=model, robot=robot)) == FAILED

    assert f"{model}:1:" in capsys.readouterr().err
