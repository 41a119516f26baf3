from domain.conditions.check import check
from domain.conditions.condition import Condition
from domain.health.built_in_errors import ALL_OF_NODES
from domain.health.signals import SignalKind, SignalSettings, SignalSpec, default_signals
from domain.parts.declared_errors import DeclaredError
from domain.parts.system_model import NodeModel, SmhModel
from domain.robot_vocabulary import vocabulary_of
from domain.state_and_mode import DEFAULT_MODE, PartName
from tests.support.models import actuation_model

SPEED = SignalSettings(SignalSpec("speed", SignalKind.NUMBER, minimum=-3.0, maximum=3.0))


def _codes(text: str, *, is_complete: bool = True) -> list[tuple[str, str]]:
    signals = (*default_signals(), SPEED)
    vocabulary = vocabulary_of(actuation_model(), signals, is_complete=is_complete)
    return [(fault.severity, fault.code) for fault in check(Condition(text), vocabulary)]


def test_parts_signals_and_errors_of_the_robot_are_known() -> None:
    assert _codes("battery_level >= 0.3 and signal_strength == CONNECTED and speed < 1") == []
    assert _codes("drive_base.mode in [SLOW, FAST] or actuation.mode == PERFORMANCE") == []
    assert _codes("drive_base.parameters.max_speed < 1 and manipulator.reachable") == []
    assert _codes("drive_base.parameters.controller == PID") == []
    assert _codes("error.GPS_LOST or error.SIGNAL_LOW or error.STALE_DATA") == []
    assert _codes("drive_base.errors.PARAMETERS_DRIFTED or actuation.errors.DEVIATES") == []


def test_what_the_robot_does_not_have_is_unknown() -> None:
    assert _codes("actuation.errors.UNREACHABLE") == [("error", "UNKNOWN_ERROR")]
    assert _codes("drive_base.mode == PERFORMANCE") == [("error", "UNKNOWN_MODE")]
    assert _codes("speed > 4") == [("warning", "NEVER_TRUE")]
    assert _codes("estop == PRESSED") == [("error", "WRONG_TYPE")]


def test_without_the_robot_file_there_may_be_more_signals() -> None:
    assert _codes("map_age_s > 1") == [("error", "UNKNOWN_SIGNAL")]
    assert _codes("map_age_s > 1", is_complete=False) == [("warning", "UNKNOWN_SIGNAL")]


def test_an_array_and_a_truth_among_the_parameters_are_told_apart() -> None:
    node = NodeModel(PartName("arm"), {DEFAULT_MODE: {"gains": (1.0, 2.0), "brake": True}})
    model = SmhModel({node.name: node}, {})
    vocabulary = vocabulary_of(model, default_signals(), is_complete=True)

    assert check(Condition("arm.parameters.brake"), vocabulary) == []
    (fault,) = check(Condition("arm.parameters.gains == 1"), vocabulary)
    assert fault.code == "WRONG_TYPE"


def test_conditions_can_name_the_errors_that_a_part_declares() -> None:
    lidar, camera = PartName("lidar"), PartName("camera")
    model = SmhModel(
        {lidar: NodeModel(lidar), camera: NodeModel(camera)},
        {},
        errors={lidar: {"SILENT": DeclaredError(), "UNREACHABLE": DeclaredError()}},
    )

    terms = vocabulary_of(model, default_signals(), is_complete=True).parts
    assert terms["lidar"].errors == (*ALL_OF_NODES, "SILENT")
    assert terms["camera"].errors == tuple(ALL_OF_NODES)
