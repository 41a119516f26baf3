import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.errors import InvalidValueError
from domain.findings import Finding
from domain.health.signals import default_signals
from domain.navigation import NavigationSettings
from domain.parts.system_model import NodeModel, SmhModel
from domain.reactions.settings import RuleSettings
from domain.state_and_mode import PartName
from domain.tasks.settings import TaskSettings
from domain.timebase import seconds
from domain.vehicle import VehicleLimits
from service.files.limits_block import LimitsBlock
from service.files.model_file import load_model
from service.files.robot_file import (
    InvalidRobotFileError,
    RobotSettings,
    read_robot_file,
    robot_settings_of,
    written_with_backend,
)
from service.files.text_file import read_text_file
from service.files.vehicle_block import PlantBlock, PoseBlock
from tests.support.models import actuation_model
from tests.support.shared import PROJECT

MODEL = actuation_model()
EXAMPLES = PROJECT / "examples" / "robots"


def faults(text: str) -> list[tuple[int | None, int | None, str]]:
    with pytest.raises(InvalidRobotFileError) as caught:
        read_robot_file(text, MODEL)
    return [(f.line, f.column, f.code) for f in caught.value.findings]


@pytest.mark.parametrize("text", ["", "# nothing is different here\n"])
def test_a_robot_of_which_nothing_is_said_is_as_usual(text: str) -> None:
    settings = read_robot_file(text, MODEL)

    assert settings == RobotSettings()
    assert settings.to_signal_settings() == default_signals()
    assert settings.nodes == {}
    assert settings.to_change_settings().transition_deadline == seconds(10)
    assert settings.to_change_settings().parameters_deadline == seconds(2)
    assert settings.to_change_settings().restored_nodes == set()
    assert settings.to_rule_settings() == RuleSettings()
    assert settings.to_vehicle_limits() == VehicleLimits()
    assert settings.to_task_settings() == TaskSettings()
    assert settings.to_navigation_settings() == NavigationSettings()
    assert settings.limits == LimitsBlock()
    assert settings.start_task is None


def test_the_nodes_that_are_restored_are_those_of_which_that_is_said() -> None:
    settings = read_robot_file(
        "nodes: {drive_base: {on_return: restore}, manipulator: {on_return: leave}}", MODEL
    )

    assert settings.to_change_settings().restored_nodes == {"drive_base"}


def test_what_is_said_holds() -> None:
    settings = read_robot_file(
        """
backend: simulated
mock: off
signals: {stale_after_s: 0}
nodes: {manipulator: {fault: fail}}
changes: {transition_deadline_s: 4}
rules: {grace_s: 0.2}
""",
        MODEL,
    )

    assert settings.mock is False
    assert {signal.stale_after for signal in settings.to_signal_settings()} == {0}
    assert settings.nodes["manipulator"].fault == "fail"
    assert settings.to_change_settings().transition_deadline == seconds(4)
    assert settings.to_rule_settings().grace == seconds(0.2)


def test_what_is_said_of_vehicle_and_driving_holds() -> None:
    settings = read_robot_file(
        """
vehicle:
  max_speed_mps: 5
  pose: {x_m: 1, y_m: -2, yaw_rad: 1.5}
  plant: {steering_lag_s: 0.15, delay_s: 0.1}
driving:
  max_start_distance_m: 8
  no_progress_for_s: 30
start_task: {file: tracks/loop.csv, controller: stanley, speed_mps: 2}
""",
        MODEL,
    )

    assert settings.to_vehicle_limits() == VehicleLimits(max_speed_mps=5.0, steering_delay_s=0.25)
    assert settings.vehicle.pose == PoseBlock(x_m=1.0, y_m=-2.0, yaw_rad=1.5)
    assert settings.vehicle.plant == PlantBlock(steering_lag_s=0.15, delay_s=0.1)
    assert settings.to_task_settings() == TaskSettings(max_start_distance_m=8.0)
    assert settings.to_navigation_settings().no_progress_for == seconds(30)
    start = settings.start_task
    assert start is not None
    assert (start.file, start.controller, start.speed_mps) == ("tracks/loop.csv", "stanley", 2.0)


@pytest.mark.parametrize(
    ("robot", "model"),
    [
        ("gem_e2", PROJECT / "examples" / "models" / "gem_e2.yaml"),
        ("actuation_with_faults", PROJECT / "service" / "example" / "actuation.yaml"),
        ("ros2_robot", PROJECT / "service" / "example" / "actuation.yaml"),
        ("ros2_tracker", PROJECT / "service" / "example" / "actuation.yaml"),
        ("watched_computer", PROJECT / "service" / "example" / "actuation.yaml"),
    ],
)
def test_the_robots_among_the_examples_load(robot: str, model: Path) -> None:
    text = read_text_file(EXAMPLES / f"{robot}.yaml")
    settings = read_robot_file(text, load_model(model).model)

    assert settings.to_signal_settings()
    assert settings != RobotSettings()


def test_no_robot_among_the_examples_is_forgotten() -> None:
    robots = sorted(path.stem for path in EXAMPLES.iterdir())

    known = ["actuation_with_faults", "gem_e2", "ros2_robot", "ros2_tracker", "watched_computer"]
    assert robots == known


def test_the_example_with_a_tracker_names_the_action_that_it_offers() -> None:
    settings = read_robot_file(read_text_file(EXAMPLES / "ros2_tracker.yaml"), MODEL)

    navigation = settings.ros2.navigation
    assert navigation is not None
    assert navigation.action == "/navigate_waypoints"


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        pytest.param("backend: simulatd\n", (1, 1, "INVALID_VALUE"), id="an unknown backend"),
        pytest.param("bakend: simulated\n", (1, 1, "UNKNOWN_KEY"), id="an unknown key"),
        pytest.param(
            "signals:\n  battery_level:\n    treshold: 0.3\n", (3, 5, "UNKNOWN_KEY"), id="deep down"
        ),
        pytest.param(
            "signals:\n  battery_level:\n    threshold: 3\n",
            (3, 5, "INVALID_VALUE"),
            id="a threshold that cannot be reached",
        ),
        pytest.param(
            "signals:\n  motor: {above: 3}\n", (2, 3, "INVALID_VALUE"), id="an error without a name"
        ),
        pytest.param("nodes:\n  tail: {}\n", (2, 3, "UNKNOWN_NODE"), id="an unknown node"),
        pytest.param("nodes:\n  actuation: {}\n", (2, 3, "UNKNOWN_NODE"), id="a system as node"),
        pytest.param("signals:\n", (1, 9, "EMPTY_VALUE"), id="a key without a value"),
        pytest.param("signals: 3\n", (1, 1, "INVALID_VALUE"), id="a value for a block"),
        pytest.param(
            "vehicle:\n  plant:\n    noise: {seed: 1.5}\n",
            (3, 13, "INVALID_VALUE"),
            id="a seed that is not whole",
        ),
        pytest.param("vehicle: {pose: {z_m: 1}}\n", (1, 18, "UNKNOWN_KEY"), id="a third axis"),
        pytest.param(
            "driving: {braking_mps2: 0}\n", (1, 11, "INVALID_VALUE"), id="a vehicle without brakes"
        ),
        pytest.param(
            "start_task: {controller: stanley}\n",
            (1, 1, "INVALID_VALUE"),
            id="a start task without a file",
        ),
        pytest.param(
            "start_task:\n  file: a.csv\n  controller: autopilot\n",
            (3, 3, "INVALID_VALUE"),
            id="an unknown tracker",
        ),
        pytest.param("- mock\n", (1, 1, "INVALID_VALUE"), id="a list"),
        pytest.param("mock: on\n---\nmock: off\n", (3, 1, "INVALID_VALUE"), id="two documents"),
        pytest.param("mock: on\nmock: off\n", (2, 1, "DUPLICATE_KEY"), id="a key twice"),
        pytest.param("mock: *on\n", (1, 7, "ALIAS"), id="an alias"),
        pytest.param("mock: [\n", (2, 1, "YAML_SYNTAX"), id="no YAML"),
    ],
)
def test_a_fault_is_told_with_its_place(text: str, fault: tuple[int, int, str]) -> None:
    assert faults(text) == [fault]


def test_all_faults_are_told_at_once() -> None:
    text = "backend: x\nmock: 3\nsignals: {estop: {for_s: 1}}\n"

    assert [code for _, _, code in faults(text)] == [
        "INVALID_VALUE",
        "INVALID_VALUE",
        "UNKNOWN_KEY",
    ]


def test_the_error_says_what_is_wrong_first() -> None:
    with pytest.raises(InvalidRobotFileError, match=r"there is no node 'tail'.*\(and 1 more\)"):
        read_robot_file("nodes: {tail: {}, horn: {}}", MODEL)


@given(
    st.text() | st.lists(st.sampled_from([*"[]{}:-\n ,'", "signals", "mock", "on"])).map("".join)
)
def test_any_text_is_a_robot_or_is_complained_of(text: str) -> None:
    assert all(finding.line is not None for finding in findings_of(text))


def findings_of(text: str) -> tuple[Finding, ...]:
    try:
        read_robot_file(text, MODEL).to_signal_settings()
    except InvalidRobotFileError as error:
        return error.findings
    return ()


def test_settings_that_were_sent_hold() -> None:
    sent = json.loads(
        """{"mock": true, "vehicle": {"pose": {"x_m": 1}}, "nodes": {"manipulator": {}},
            "signals": {"wind_speed": {"unit": "m/s"}}, "driving": {"max_cross_track_m": 2}}"""
    )
    settings = robot_settings_of(sent, MODEL)

    assert settings.mock is True
    assert settings.vehicle.pose == PoseBlock(x_m=1.0)
    assert settings.nodes.keys() == {"manipulator"}
    assert settings.to_navigation_settings().max_cross_track_m == 2.0


def test_of_a_robot_of_which_nothing_is_sent_all_is_as_usual() -> None:
    assert robot_settings_of({}, MODEL) == RobotSettings()


@pytest.mark.parametrize(
    ("sent", "pointer", "words"),
    [
        ({"bakend": 1}, "/bakend", "unknown key"),
        ({"backend": "ros1"}, "/backend", "'simulated'"),
        ({"vehicle": 3}, "/vehicle", "expected keys below"),
        ({"vehicle": {"pose": {"x_m": "1"}}}, "/vehicle/pose/x_m", "valid number"),
        ({"vehicle": {"plant": {"delay_s": -1}}}, "/vehicle/plant/delay_s", "greater than"),
        ({"driving": {"speed": 3}}, "/driving/speed", "unknown key"),
        ({"nodes": {"tail": {}}}, "/nodes/tail", "there is no node 'tail'"),
        ({"nodes": {"actuation": {}}}, "/nodes/actuation", "'actuation' is a system, not a node"),
        ({"nodes": {"/tail": {}}}, "/nodes/tail", "there is no node 'tail'"),
        ({"nodes": {"x": {}, "/x": {}}}, "/nodes", "x is named twice"),
        ({"nodes": {"manipulator": {"fault": "x"}}}, "/nodes/manipulator/fault", "'slow'"),
        ({"signals": {"motor": {"above": 3}}}, "/signals/motor", "error requires"),
        (
            {"signals": {"battery_level": {"threshold": 3}}},
            "/signals/battery_level/threshold",
            "can never be reached",
        ),
    ],
)
def test_a_fault_in_what_was_sent_is_told_with_a_pointer(
    sent: dict[str, object], pointer: str, words: str
) -> None:
    with pytest.raises(InvalidValueError, match=words) as caught:
        robot_settings_of(sent, MODEL)

    assert caught.value.pointer == pointer


@pytest.mark.parametrize(
    ("sent", "pointer"),
    [
        ({"nodes": {"left/a~b": {}}}, "/nodes/left~1a~0b"),
        ({"nodes": {"left/arm": {"fault": "x"}}}, "/nodes/left~1arm/fault"),
    ],
)
def test_a_slash_in_the_name_of_a_node_does_not_lead_elsewhere(
    sent: dict[str, object], pointer: str
) -> None:
    arm = PartName("left/arm")
    model = SmhModel({arm: NodeModel(arm, {})}, {})
    with pytest.raises(InvalidValueError) as caught:
        robot_settings_of(sent, model)

    assert caught.value.pointer == pointer


def test_names_are_taken_with_the_leading_slash_of_ros() -> None:
    settings = read_robot_file(
        """
signals: {/estop: {stale_after_s: 9}, /load: {above: 3, error: LOAD}}
nodes: {/drive_base: {configure_s: 0.5}}
ros2: {signals: {/load: {topic: /load, type: std_msgs/msg/Float32, field: data}}}
""",
        MODEL,
    )

    assert settings.signals.estop.stale_after_s == 9
    assert [*settings.signals.further] == ["load"]
    assert settings.nodes["drive_base"].configure_s == 0.5
    assert [*settings.ros2.signals] == ["load"]


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("nodes:\n  /drive_base: {}\n  drive_base: {}\n", (1, 1, "INVALID_VALUE")),
        ("signals:\n  /estop: {}\n  estop: {}\n", (1, 1, "INVALID_VALUE")),
        ("nodes:\n  a: {}\n  /actuation: {}\n", (3, 3, "UNKNOWN_NODE")),
        ("signals:\n  /estop: {above: 3}\n", (2, 12, "UNKNOWN_KEY")),
    ],
)
def test_a_fault_of_a_name_with_a_slash_is_told_where_it_is(
    text: str, place: tuple[int, int, str]
) -> None:
    assert place in faults(text)


@pytest.mark.parametrize("start_task", [{"file": "/etc/passwd"}, {}, None])
def test_who_sends_settings_names_no_files(start_task: object) -> None:
    with pytest.raises(InvalidValueError, match="allowed only in a robot file") as caught:
        robot_settings_of({"start_task": start_task}, MODEL)

    assert caught.value.pointer == "/start_task"


def test_limits_are_set_in_a_robot_file_and_do_no_harm_in_a_simulation() -> None:
    limits = {"json_bytes": 2_000, "requests_per_s": 5}

    assert read_robot_file("limits: {json_bytes: 2000, requests_per_s: 5}", MODEL).limits == (
        LimitsBlock.model_validate(limits)
    )
    assert robot_settings_of({"limits": limits}, MODEL).limits.requests_per_s == 5
    assert faults("limits:\n  json_bytes: 1\n") == [(2, 3, "INVALID_VALUE")]
    assert faults("limits:\n  bytes: 1\n") == [(2, 3, "UNKNOWN_KEY")]


def test_in_a_simulation_the_trackers_on_board_drive() -> None:
    said = {"backend": "ros2", "ros2": {"navigation": {"action": "/go"}}}

    assert robot_settings_of(said, MODEL).to_controller_settings() is None
    text = "backend: ros2\nros2: {navigation: {action: /go}}\n"
    controller = read_robot_file(text, MODEL).to_controller_settings()
    assert controller is not None
    assert controller.name == "/go"


def test_a_backend_that_the_command_named_is_in_the_file_that_a_log_keeps() -> None:
    text = "backend: ros2\nros2: {navigation: {action: /go}}\n"
    written = written_with_backend(text, "simulated")

    kept = read_robot_file(written, MODEL)
    assert (kept.backend, kept.to_controller_settings()) == ("simulated", None)
    assert kept.ros2 == read_robot_file(text, MODEL).ros2
