"""Which errors explain which, before anything happens."""

import pytest

from domain.conditions.condition import Condition
from domain.health.error_causes import MAX_SHOWN, ErrorCauses
from domain.lifecycle import LifecycleState
from domain.parts.declared_errors import DeclaredError
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import DEFAULT_MODE, PartName, StateAndMode
from tests.support.models import active

ROBOT, SENSORS = PartName("robot"), PartName("sensors")
LIDAR, CAMERA = PartName("lidar"), PartName("camera")
UP = StateAndMode(LifecycleState.ACTIVE)
LOST = ErrorKey(LIDAR, "UNREACHABLE")
OFF = ErrorKey(LIDAR, "DEVIATES")
SENSORS_OFF, ROBOT_OFF = ErrorKey(SENSORS, "DEVIATES"), ErrorKey(ROBOT, "DEVIATES")


def causes(**errors: dict[str, DeclaredError]) -> ErrorCauses:
    """Return the graph of a robot whose sensors are a lidar and a camera."""
    sensors = SystemModel(SENSORS, {DEFAULT_MODE: {LIDAR: UP, CAMERA: UP}})
    robot = SystemModel(ROBOT, {DEFAULT_MODE: {SENSORS: active()}})
    nodes = {name: NodeModel(name) for name in (LIDAR, CAMERA)}
    declared = {PartName(part): own for part, own in errors.items()}
    return ErrorCauses(SmhModel(nodes, {ROBOT: robot, SENSORS: sensors}, errors=declared))


def present(graph: ErrorCauses, key: ErrorKey, *on: ErrorKey) -> list[str]:
    by_name: dict[str, dict[PartName, None]] = {}
    for each in on:
        if each.part is not None:
            by_name.setdefault(each.error, {})[each.part] = None
    return [cause.name for cause in graph.present(key, by_name, on.__contains__)]


def silent(text: str = "not lidar.reachable", *causes: ErrorKey) -> dict[str, DeclaredError]:
    return {"SILENT": DeclaredError(when=Condition(text), caused_by=causes)}


def test_a_node_deviates_because_it_is_unreachable_and_a_system_because_of_its_parts() -> None:
    graph = causes()
    assert present(graph, OFF, LOST, OFF) == ["lidar.UNREACHABLE"]
    assert present(graph, SENSORS_OFF, LOST, OFF) == ["lidar.DEVIATES", "lidar.UNREACHABLE"]
    assert present(graph, ROBOT_OFF, LOST, OFF, SENSORS_OFF) == ["sensors.DEVIATES"]
    everything = {OFF, SENSORS_OFF, ROBOT_OFF}
    assert list(graph.effects(LOST, everything.__contains__)) == [OFF, SENSORS_OFF]
    assert list(graph.effects(SENSORS_OFF, everything.__contains__)) == [ROBOT_OFF]
    assert list(graph.effects(LOST, {OFF}.__contains__)) == [OFF], "the rest is not on"


def test_causes_that_are_off_explain_nothing() -> None:
    assert present(causes(), SENSORS_OFF) == []


@pytest.mark.parametrize(
    ("text", "causes_"),
    [
        ("not lidar.reachable", ["lidar.UNREACHABLE"]),
        ("lidar.reachable == false or battery_level < 0.1", ["lidar.UNREACHABLE"]),
        ("lidar.reachable != true", ["lidar.UNREACHABLE"]),
        ("not lidar.converged", ["lidar.UNREACHABLE"]),
        ("not sensors.reachable", ["lidar.UNREACHABLE", "camera.UNREACHABLE"]),
        ("lidar.reachable and battery_level < 0.1", []),
        ("lidar.state != active", []),
    ],
)
def test_what_rests_on_a_node_that_is_not_reachable_is_explained_by_that(
    text: str, causes_: list[str]
) -> None:
    key = ErrorKey(ROBOT, "SILENT")
    on = (LOST, ErrorKey(CAMERA, "UNREACHABLE"))
    assert present(causes(robot=silent(text)), key, *on) == causes_


def test_what_is_declared_comes_first_and_prevails_where_both_would_close_a_circle() -> None:
    cut = ErrorKey(ROBOT, "CUT")
    graph = causes(
        robot={"CUT": DeclaredError(when=Condition("not lidar.reachable"))},
        lidar={"UNREACHABLE": DeclaredError(caused_by=(cut,))},
    )
    assert present(graph, LOST, cut) == ["robot.CUT"]
    assert present(graph, cut, LOST) == []
    assert graph.place(cut) < graph.place(LOST) < graph.place(OFF)


def test_a_deviation_that_is_declared_to_have_a_cause_has_those_of_its_part_as_well() -> None:
    blown = ErrorKey(None, "BATTERY_LOW")
    graph = causes(sensors={"DEVIATES": DeclaredError(caused_by=(blown,))})
    assert present(graph, SENSORS_OFF, blown, OFF) == ["BATTERY_LOW", "lidar.DEVIATES"]
    assert list(graph.declared_effects(blown)) == [SENSORS_OFF]
    assert list(graph.effects(OFF, {SENSORS_OFF}.__contains__)) == [SENSORS_OFF]


def test_an_error_is_decided_after_all_that_it_depends_on_then_as_in_the_file() -> None:
    late = DeclaredError(when=Condition("lidar.errors.SILENT"))
    blind = DeclaredError(
        caused_by=(ErrorKey(LIDAR, "LATE"),), unless=Condition("camera.errors.SILENT")
    )
    graph = causes(
        robot={"BLIND": blind},
        lidar={"LATE": late, "SILENT": DeclaredError(when=Condition("not lidar.reachable"))},
        camera=silent("not camera.reachable"),
    )
    keys = [ErrorKey(p, e) for p, e in ((ROBOT, "BLIND"), (LIDAR, "LATE"), (LIDAR, "SILENT"))]
    keys += [ErrorKey(CAMERA, "SILENT"), LOST]
    ordered = [key.name for key in sorted(keys, key=graph.place)]
    assert ordered == [
        "lidar.UNREACHABLE",
        "lidar.SILENT",
        "camera.SILENT",
        "lidar.LATE",
        "robot.BLIND",
    ]


def test_a_long_chain_is_ordered_without_recursion() -> None:
    chain = {"E0": DeclaredError()}
    for number in range(1, 3_000):
        chain[f"E{number}"] = DeclaredError(caused_by=(ErrorKey(LIDAR, f"E{number - 1}"),))
    graph = causes(lidar=chain)
    level, *_ = graph.place(ErrorKey(LIDAR, "E2999"))
    assert level == 2_999


def test_no_more_causes_are_shown_than_can_be_read() -> None:
    keys = tuple(ErrorKey(CAMERA, f"E{number}") for number in range(MAX_SHOWN + 5))
    graph = causes(lidar={"BLIND": DeclaredError(caused_by=keys)})
    assert len(present(graph, ErrorKey(LIDAR, "BLIND"), *keys)) == MAX_SHOWN


def test_the_names_of_a_part_are_the_built_in_ones_and_then_those_of_the_file() -> None:
    graph = causes(lidar=silent() | {"DEVIATES": DeclaredError()})
    assert list(graph.names_of(LIDAR))[-2:] == ["INVARIANT_BROKEN", "SILENT"]
    assert list(graph.names_of(LIDAR)).count("DEVIATES") == 1
    assert "UNREACHABLE" not in list(graph.names_of(ROBOT))


def test_only_what_is_declared_with_neither_condition_nor_causes_is_reported() -> None:
    graph = causes(
        lidar=silent() | {"JAMMED": DeclaredError(), "UNREACHABLE": DeclaredError()},
        camera={"BLIND": DeclaredError(caused_by=(LOST,))},
    )
    assert graph.is_reported(ErrorKey(LIDAR, "JAMMED"))
    assert not graph.is_reported(ErrorKey(LIDAR, "SILENT"))
    assert not graph.is_reported(ErrorKey(LIDAR, "UNREACHABLE"))
    assert not graph.is_reported(ErrorKey(CAMERA, "BLIND"))
    assert not graph.is_reported(ErrorKey(CAMERA, "JAMMED"))


# --- devices -------------------------------------------------------------------------------------

ARM = PartName("arm")
GONE = ErrorKey(ARM, "LOST")


def with_device(**errors: dict[str, DeclaredError]) -> ErrorCauses:
    """Return the graph of a robot whose lidar is on a device."""
    nodes = {name: NodeModel(name) for name in (LIDAR, CAMERA)}
    declared = {PartName(part): own for part, own in errors.items()}
    model = SmhModel(nodes, {}, errors=declared)
    return ErrorCauses(model, devices={ARM: (LIDAR,)})


def test_a_node_is_unreachable_because_its_device_is_lost() -> None:
    graph = with_device()
    other = ErrorKey(CAMERA, "UNREACHABLE")

    assert present(graph, LOST, GONE) == ["arm.LOST"]
    assert present(graph, LOST) == []
    assert present(graph, other, GONE) == []
    assert list(graph.effects(GONE, {GONE, LOST, other}.__contains__)) == [LOST]
    assert list(graph.effects(ErrorKey(ARM, "LATE"), {LOST}.__contains__)) == []
    assert graph.place(GONE) < graph.place(LOST)


def test_what_the_file_says_of_an_unreachable_node_counts_beside_its_device() -> None:
    graph = with_device(lidar={"UNREACHABLE": DeclaredError(severity=Severity.WARNING)})

    assert present(graph, LOST, GONE) == ["arm.LOST"]
    assert list(graph.effects(GONE, {GONE, LOST}.__contains__)) == [LOST]
    assert graph.place(GONE) < graph.place(LOST)
    assert graph.severity_of(LOST) is Severity.WARNING


def test_a_device_has_the_errors_of_devices() -> None:
    graph = with_device()

    assert list(graph.names_of(ARM)) == ["LATE", "LOST", "DEVICE_CONFLICT"]
    assert "LOST" not in graph.names_of(LIDAR)
    assert [graph.is_of_device(key) for key in (GONE, LOST, ErrorKey(None, "ESTOP"))] == [
        True,
        False,
        False,
    ]


@pytest.mark.parametrize(
    ("error", "severity"),
    [("LATE", "warning"), ("LOST", "urgent"), ("DEVICE_CONFLICT", "urgent"), ("OTHER", "warning")],
)
def test_a_lost_device_is_urgent_and_a_late_one_is_not(error: str, severity: str) -> None:
    assert with_device().severity_of(ErrorKey(ARM, error)) == severity


def with_process(**errors: dict[str, DeclaredError]) -> ErrorCauses:
    """Return the graph of a robot whose lidar has a process that runs here."""
    nodes = {name: NodeModel(name) for name in (LIDAR, CAMERA)}
    declared = {PartName(part): own for part, own in errors.items()}
    return ErrorCauses(SmhModel(nodes, {}, errors=declared), with_processes={LIDAR})


@pytest.mark.parametrize("error", ["PROCESS_ENDED", "PROCESS_GIVEN_UP"])
def test_a_node_is_unreachable_because_its_process_ended(error: str) -> None:
    graph, ended = with_process(), ErrorKey(LIDAR, error)

    assert present(graph, LOST, ended) == [f"lidar.{error}"]
    assert list(graph.effects(ended, {ended, LOST}.__contains__)) == [LOST]
    assert list(graph.effects(ended, {ended}.__contains__)) == []
    assert graph.place(ended) < graph.place(LOST)


def test_what_the_file_says_of_an_unreachable_node_counts_beside_its_process() -> None:
    graph = with_process(lidar={"UNREACHABLE": DeclaredError(severity=Severity.WARNING)})
    ended = ErrorKey(LIDAR, "PROCESS_ENDED")

    assert present(graph, LOST, ended) == ["lidar.PROCESS_ENDED"]
    assert list(graph.effects(ended, {ended, LOST}.__contains__)) == [LOST]


def test_only_a_node_whose_process_runs_here_has_its_errors() -> None:
    graph = with_process()

    assert "PROCESS_ENDED" in graph.names_of(LIDAR)
    assert "PROCESS_ENDED" not in graph.names_of(CAMERA)
