import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Literal

import pytest

from api.serving.composition import (
    Composition,
    ServeOptions,
    compose,
    open_stores,
    read_files,
)
from api.serving.misuse import MisuseError
from domain.errors import InvalidModelError
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.files.robot_file import RobotSettings, read_robot_file
from service.link.supervisor_end import SupervisorEnd
from service.onboard_parts import make_onboard
from service.replay import core_of_boot
from service.ros.graph.graph import UnknownFieldError, UnknownTypeError
from service.ros.interface.message_sets import MessageSet
from service.simulation.mock_source import MockHandle
from service.start_task import StartTaskError
from tests.support.manual_clock import ManualClock
from tests.support.ros_graph import FakeGraph

LINK = "service.ros.graph.link"


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    return tmp_path / "robot.yaml"


def composed(options: ServeOptions) -> Composition:
    return compose(options, ManualClock(), read_files(options))


@pytest.fixture
def _ros(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let there be ROS 2 on this machine."""
    link = SimpleNamespace(RosLink=lambda: FakeGraph(ManualClock()))
    monkeypatch.setitem(sys.modules, LINK, link)


def test_without_arguments_the_example_is_served_with_everything_simulated() -> None:
    composition = composed(ServeOptions())

    assert "actuation" in composition.supervisor.model.systems
    assert composition.supervisor.simulated == ("nodes", "signals", "vehicle")
    assert composition.supervisor.warnings == ()
    assert composition.gateway is None


def test_the_log_keeps_a_robot_file_with_its_templates_written_out(robot: Path) -> None:
    robot.write_text(
        "include:\n  - topic: {name: scan, topic: /scan, type: sensor_msgs/msg/LaserScan,"
        " min_hz: 8, max_gap_s: 0.5}\n"
    )
    files = read_files(ServeOptions(robot=robot))

    assert "include" not in files.text
    assert "SCAN_SLOW" in files.text


def test_a_robot_file_may_turn_the_mock_off(robot: Path) -> None:
    robot.write_text("mock: false\n")
    supervisor = composed(ServeOptions(robot=robot)).supervisor

    assert supervisor.simulated == ("nodes", "vehicle")


def test_the_command_line_may_turn_the_mock_on_again(robot: Path) -> None:
    robot.write_text("mock: false\n")
    supervisor = composed(ServeOptions(robot=robot, mock_signals=True)).supervisor

    assert supervisor.readings.mock is not None


def test_the_settings_of_a_robot_file_reach_the_core_and_the_service(robot: Path) -> None:
    robot.write_text("signals: {battery_level: {threshold: 0.3}}\nlimits: {stream_clients: 3}\n")
    composition = composed(ServeOptions(robot=robot))

    signal = composition.supervisor.core.signal("battery_level")
    assert signal.settings["threshold"] == 0.3
    assert composition.limits.stream_clients == 3


def test_a_simulated_robot_may_name_its_messages_as_smart_polaris_does(
    robot: Path, caplog: pytest.LogCaptureFixture
) -> None:
    robot.write_text("ros2: {messages: gem_state_msgs}\n")

    assert composed(ServeOptions(robot=robot)).interface.messages is MessageSet.GEM
    assert caplog.records == []


def test_the_folder_of_waypoint_files_is_beside_the_robot_file(
    robot: Path, caplog: pytest.LogCaptureFixture
) -> None:
    robot.write_text("tasks: {folder: tracks}\n")

    folder = composed(ServeOptions(robot=robot)).interface.folder
    assert folder is not None
    assert folder.path == robot.parent / "tracks"
    assert "there is no folder" in caplog.text

    caplog.clear()
    folder.path.mkdir()
    composed(ServeOptions(robot=robot))
    assert caplog.records == []


@pytest.fixture
def watching_a_rate(robot: Path) -> Path:
    robot.write_text(
        "mock: false\nsignals:\n  scan: {}\n"
        "  scan_rate: {of: scan, statistic: rate, window_s: 2.0, below: 3.0, error: SCAN_SLOW}\n"
    )
    return robot


@pytest.mark.parametrize("backend", ["simulated", "ros2"])
@pytest.mark.usefixtures("_ros")
async def test_the_core_begins_with_its_record_however_long_it_took_to_open_that(
    watching_a_rate: Path, backend: Literal["simulated", "ros2"]
) -> None:
    clock = ManualClock()
    options = ServeOptions(robot=watching_a_rate, backend=backend, data=":memory:")
    files = read_files(options)

    stores = await open_stores(options, files, clock)
    clock.stall(0.3)
    core = compose(options, clock, files, stores).supervisor.core

    assert stores.journal is not None
    again = core_of_boot(stores.journal.boot).core
    assert core.wake_at() == again.wake_at() == seconds(2.0)


def test_a_start_task_that_cannot_be_driven_is_told(robot: Path) -> None:
    (robot.parent / "path.csv").write_text("0,0,0\n")
    robot.write_text("start_task: {file: path.csv}\n")

    with pytest.raises(StartTaskError, match=r"path\.csv"):
        composed(ServeOptions(robot=robot))


GUARDED = """\
arm:
  ros__parameters:
    type: node
    modes: {__DEFAULT__: {ros__parameters: {torque: 0.1}}}
    mode_settings: {__DEFAULT__: {requires: "reach > 3"}}
"""


def test_a_guard_on_a_signal_that_the_robot_file_does_not_declare_keeps_the_service_from_starting(
    robot: Path, tmp_path: Path
) -> None:
    model = tmp_path / "arm.yaml"
    model.write_text(GUARDED)
    robot.write_text("mock: true\n")

    with pytest.raises(InvalidModelError) as caught:
        composed(ServeOptions(model=model, robot=robot))
    assert [finding.code for finding in caught.value.findings] == ["UNKNOWN_SIGNAL"]


def test_a_guard_on_a_signal_that_the_robot_file_declares_is_no_reason_to_warn(
    robot: Path, tmp_path: Path
) -> None:
    model = tmp_path / "arm.yaml"
    model.write_text(GUARDED)
    robot.write_text("signals: {reach: {minimum: 0}}\n")

    assert composed(ServeOptions(model=model, robot=robot)).supervisor.warnings == ()


def test_without_a_robot_file_a_guard_on_an_unknown_signal_is_a_warning(tmp_path: Path) -> None:
    model = tmp_path / "arm.yaml"
    model.write_text(GUARDED)

    warnings = composed(ServeOptions(model=model)).supervisor.warnings
    assert [finding.code for finding in warnings] == ["UNKNOWN_SIGNAL"]


def test_nothing_set_is_a_robot_file_without_content() -> None:
    assert RobotSettings().mock is None


SOURCES = """\
signals:
  cpu: {unit: "%", source: {os: {what: cpu_percent}}}
  battery_level: {source: {file: {path: /sys/class/power_supply/BAT0/capacity, scale: 0.01}}}
  load: {unit: kg, source: {http: {period_s: 5}}}
"""


def test_the_sources_of_a_robot_file_are_run_and_the_mock_leaves_their_signals_alone(
    robot: Path,
) -> None:
    robot.write_text(SOURCES)
    supervisor = composed(ServeOptions(robot=robot)).supervisor

    assert [(source.name, source.signals) for source in supervisor.sources] == [
        ("os", ("cpu",)),
        ("file /sys/class/power_supply/BAT0/capacity", ("battery_level",)),
    ]
    assert supervisor.readings.mock is not None
    published = {signal.signal for signal in supervisor.readings.mock.view() if signal.publishing}
    assert published == {"estop", "gps_accuracy", "signal_strength", "temperature"}


@pytest.mark.usefixtures("_ros")
@pytest.mark.parametrize("mocked", [True, False])
def test_a_robot_in_ros_2_has_its_sources_too(robot: Path, mocked: bool) -> None:
    robot.write_text("backend: ros2\n" + SOURCES)
    supervisor = composed(ServeOptions(robot=robot, mock_signals=mocked)).supervisor

    assert len(supervisor.sources) == 2


# --- ROS 2 ---------------------------------------------------------------------------------------


@pytest.mark.usefixtures("_ros")
def test_real_nodes_are_reached_where_that_is_said() -> None:
    composition = composed(ServeOptions(backend="ros2"))

    assert composition.gateway is not None
    assert composition.simulated is None
    assert composition.supervisor.simulated == ()
    assert composition.supervisor.readings.mock is None


@pytest.mark.usefixtures("_ros")
def test_a_robot_file_says_so_too_and_the_command_line_has_the_last_word(robot: Path) -> None:
    robot.write_text("backend: ros2\n")

    assert composed(ServeOptions(robot=robot)).gateway is not None
    simulated = composed(ServeOptions(robot=robot, backend="simulated"))
    assert simulated.gateway is None
    assert simulated.supervisor.simulated == ("nodes", "signals", "vehicle")


@pytest.mark.usefixtures("_ros")
@pytest.mark.parametrize(
    ("text", "flag", "mocked"),
    [("", False, False), ("mock: false", True, True), ("mock: true", False, True)],
)
def test_signals_of_a_real_robot_are_mocked_only_where_that_is_asked(
    robot: Path, text: str, flag: bool, mocked: bool
) -> None:
    robot.write_text(f"{text}\n")
    options = ServeOptions(robot=robot, backend="ros2", mock_signals=flag)
    supervisor = composed(options).supervisor

    assert (supervisor.readings.mock is not None) is mocked
    assert supervisor.simulated == (("signals",) if mocked else ())


@pytest.mark.parametrize(
    "topics",
    [
        "signals: {estop: {topic: /e, type: gone_msgs/msg/Stop, field: pressed}}",
        "command: {topic: /c, type: ackermann_msgs/msg/AckermannDrive}",
        "navigation: {action: /go, type: nav2_msgs/action/FollowPath}",
    ],
)
def test_a_type_that_the_robot_file_names_has_to_be_there(
    robot: Path, topics: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    absent = (
        "gone_msgs/msg/Stop",
        "ackermann_msgs/msg/AckermannDrive",
        "nav2_msgs/action/FollowPath",
    )
    link = SimpleNamespace(RosLink=lambda: FakeGraph(ManualClock(), absent))
    monkeypatch.setitem(sys.modules, LINK, link)
    robot.write_text(f"ros2: {{{topics}}}\n")

    with pytest.raises(UnknownTypeError, match="install its package"):
        composed(ServeOptions(robot=robot, backend="ros2"))


@pytest.mark.usefixtures("_ros")
def test_a_field_that_the_robot_file_names_has_to_be_there(robot: Path) -> None:
    topic = "{topic: /load, type: std_msgs/msg/Float64, field: no_such_field}"
    robot.write_text(f"ros2: {{signals: {{temperature: {topic}}}}}\n")

    with pytest.raises(UnknownFieldError, match="has no field no_such_field; it has data"):
        composed(ServeOptions(robot=robot, backend="ros2"))


@pytest.mark.usefixtures("_ros")
def test_goals_go_to_the_controller_that_the_robot_file_names(robot: Path) -> None:
    robot.write_text("ros2: {navigation: {action: /go}}\n")
    composition = composed(ServeOptions(robot=robot, backend="ros2"))

    assert composition.supervisor.navigation is not None
    composition.supervisor.let_pass()
    assert "navigation" in composition.supervisor.core.driving.holds


def test_topics_of_a_robot_that_is_simulated_are_said_to_have_no_effect(
    robot: Path, caplog: pytest.LogCaptureFixture
) -> None:
    robot.write_text("ros2: {odometry: {topic: /odom}}\n")

    composed(ServeOptions(robot=robot))

    assert "`ros2` of the robot file has no effect" in caplog.text


DEVICES = """\
name: lawn
devices:
  arm: {parts: [manipulator], offline: {after_s: 2, target: {manipulator: inactive}}}
"""


@pytest.fixture
def _zenoh() -> None:
    pytest.importorskip("zenoh")


@pytest.mark.usefixtures("_zenoh")
def test_the_mock_of_a_supervisor_leaves_alone_what_devices_read(robot: Path) -> None:
    robot.write_text("devices: {arm: {parts: [manipulator], signals: [temperature]}}\n")
    mock = composed(ServeOptions(robot=robot)).supervisor.readings.mock

    assert isinstance(mock, MockHandle)
    (first,) = mock.due()
    assert [reading.signal for reading in first.items] == [
        "battery_level",
        "estop",
        "gps_accuracy",
        "signal_strength",
    ]


@pytest.mark.usefixtures("_zenoh")
def test_a_device_runs_its_own_part_and_has_no_vehicle(robot: Path) -> None:
    robot.write_text(DEVICES)
    files = read_files(ServeOptions(robot=robot, device="arm"))
    composition = compose(ServeOptions(robot=robot, device="arm"), ManualClock(), files)

    assert files.name == "lawn-arm"
    assert composition.supervisor.model.parts == ("manipulator",)
    assert composition.supervisor.simulated == ("nodes",)
    assert composition.simulated is None
    assert composition.place is not None
    assert composition.place.name == "arm"


@pytest.mark.usefixtures("_zenoh")
def test_the_log_of_a_device_can_be_replayed_since_it_says_which_device_it_is(robot: Path) -> None:
    robot.write_text(DEVICES)
    files = read_files(ServeOptions(robot=robot, device="arm"))

    again = read_robot_file(files.text, files.loaded.model)
    onboard = make_onboard(files.loaded.model, again, 0)
    assert onboard.core.model.parts == ("manipulator",)
    assert onboard.core.lead() is not None


@pytest.mark.usefixtures("_zenoh")
def test_the_supervisor_runs_the_whole_robot_and_simulates_what_no_device_owns(
    robot: Path,
) -> None:
    robot.write_text(DEVICES)
    files = read_files(ServeOptions(robot=robot))
    composition = compose(ServeOptions(robot=robot), ManualClock(), files)

    assert "manipulator" in composition.supervisor.model.parts
    assert tuple(files.share.local_model.nodes) == ("drive_base",)
    assert isinstance(composition.supervisor.link, SupervisorEnd)
    assert composition.supervisor.core.part(PartName("manipulator")).device == "arm"
    assert composition.supervisor.core.part(PartName("drive_base")).device is None


def test_a_device_that_the_robot_file_does_not_have_is_refused(robot: Path) -> None:
    robot.write_text(DEVICES)

    with pytest.raises(MisuseError, match=r"no device 'arn'; known: arm"):
        read_files(ServeOptions(robot=robot, device="arn"))


def test_a_robot_of_one_computer_has_no_link(robot: Path) -> None:
    composition = composed(ServeOptions())

    assert composition.supervisor.link is None
    assert composition.place is None


PROCESS = "nodes: {drive_base: {process: {command: [base]}}}\n"


def test_programs_of_simulated_nodes_are_not_run_and_that_is_told(
    robot: Path, caplog: pytest.LogCaptureFixture
) -> None:
    robot.write_text(PROCESS)

    assert composed(ServeOptions(robot=robot)).supervisor.processes is None
    assert "`process` of the robot file has no effect" in caplog.text


@pytest.mark.usefixtures("_ros")
def test_programs_of_real_nodes_are_run(robot: Path) -> None:
    robot.write_text(PROCESS)

    assert composed(ServeOptions(robot=robot, backend="ros2")).supervisor.processes is not None
    robot.write_text("nodes: {drive_base: {}}\n")
    assert composed(ServeOptions(robot=robot, backend="ros2")).supervisor.processes is None


def test_what_is_simulated_can_be_given_faults() -> None:
    faults = composed(ServeOptions()).supervisor.live_faults

    assert faults is not None
    assert set(faults.node_faults) == {"drive_base", "manipulator"}
