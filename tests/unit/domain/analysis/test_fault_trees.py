from domain.analysis.fault_trees import ErrorGraph, FaultTree, error_graph, fault_trees
from domain.conditions.condition import Condition
from domain.parts.declared_errors import DeclaredError
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import DEFAULT_MODE, PartName, StateAndMode

CARRIER, LIDAR, CAMERA, MAPPER = map(PartName, ("carrier", "lidar", "camera", "mapper"))
ACTIVE = StateAndMode.parse("active")
ESTOP, RADIO = ErrorKey(None, "ESTOP"), ErrorKey(None, "RADIO_WEAK")
OWN = {ESTOP: Severity.CRITICAL, RADIO: Severity.WARNING}
BLIND, LATE = ErrorKey(CARRIER, "BLIND"), ErrorKey(MAPPER, "LATE")
SILENT, DARK = ErrorKey(LIDAR, "SILENT"), ErrorKey(CAMERA, "DARK")

DETECTED = DeclaredError(when=Condition("battery_level < 0.1"))
REPORTED = DeclaredError()


def follows(*causes: ErrorKey, severity: Severity | None = None) -> DeclaredError:
    return DeclaredError(caused_by=causes, severity=severity)


def follows_from_all(*causes: ErrorKey, severity: Severity | None = None) -> DeclaredError:
    return DeclaredError(caused_by=causes, need_all=True, severity=severity)


def graph(errors: dict[ErrorKey, DeclaredError]) -> ErrorGraph:
    """Return the errors of a carrier with two sensors and a mapper."""
    nodes = {name: NodeModel(name) for name in (LIDAR, CAMERA, MAPPER)}
    carrier = SystemModel(CARRIER, {DEFAULT_MODE: dict.fromkeys(nodes, ACTIVE)})
    by_part: dict[PartName, dict[str, DeclaredError]] = {}
    for key, error in errors.items():
        assert key.part is not None
        by_part.setdefault(key.part, {})[key.error] = error
    return error_graph(SmhModel(nodes, {CARRIER: carrier}, errors=by_part), OWN)


def trees(errors: dict[ErrorKey, DeclaredError]) -> dict[ErrorKey, FaultTree]:
    return {tree.key: tree for tree in fault_trees(graph(errors))}


def test_a_following_error_has_the_sets_of_errors_that_raise_it() -> None:
    found = trees(
        {
            BLIND: follows_from_all(LATE, DARK, severity=Severity.CRITICAL),
            LATE: follows(SILENT, ErrorKey(LIDAR, "UNREACHABLE")),
            SILENT: DETECTED,
            DARK: REPORTED,
        }
    )

    assert found[BLIND].cut_sets == (
        (ErrorKey(LIDAR, "UNREACHABLE"), DARK),
        (SILENT, DARK),
    )
    assert found[BLIND].single_points == ()


def test_what_leads_to_an_error_alone_is_its_single_point_of_failure() -> None:
    found = trees({BLIND: follows(SILENT, ESTOP, severity=Severity.FATAL), SILENT: DETECTED})

    assert found[BLIND].severity is Severity.FATAL
    assert found[BLIND].single_points == (ESTOP, SILENT)


def test_causes_of_a_detected_error_explain_it_and_do_not_raise_it() -> None:
    explained = DeclaredError(when=Condition("battery_level < 0.1"), caused_by=(SILENT,))

    found = trees({BLIND: follows(LATE, severity=Severity.CRITICAL), LATE: explained})

    assert found[BLIND].cut_sets == ((LATE,),)


def test_causes_of_a_built_in_error_explain_it_and_do_not_raise_it() -> None:
    deviates = ErrorKey(MAPPER, "DEVIATES")

    found = trees({deviates: follows(SILENT, severity=Severity.CRITICAL)})

    assert found[deviates].cut_sets == ((deviates,),)
    assert found[deviates].is_basic


def test_only_critical_and_fatal_errors_are_analysed() -> None:
    errors = {
        SILENT: DeclaredError(severity=Severity.URGENT),
        DARK: DeclaredError(severity=Severity.CRITICAL),
        LATE: REPORTED,
    }

    assert list(trees(errors)) == [ESTOP, DARK]


def test_an_error_without_a_severity_is_a_warning_unless_it_is_built_in() -> None:
    unreachable = ErrorKey(LIDAR, "UNREACHABLE")

    assert list(trees({LATE: follows(SILENT), unreachable: REPORTED})) == [ESTOP]


def test_errors_come_in_the_order_of_the_model_those_of_the_robot_first() -> None:
    critical = DeclaredError(severity=Severity.CRITICAL)

    found = trees(dict.fromkeys((LATE, DARK, SILENT, BLIND), critical))

    assert list(found) == [ESTOP, BLIND, SILENT, DARK, LATE]


def test_unless_and_times_leave_no_combination_out() -> None:
    careful = DeclaredError(
        caused_by=(SILENT,),
        unless=Condition("vehicle.speed_mps < 0.05"),
        after=10,
        severity=Severity.CRITICAL,
    )

    assert trees({BLIND: careful})[BLIND].cut_sets == ((SILENT,),)


def test_a_cause_that_is_not_known_is_a_basic_event() -> None:
    # Without the robot file, nobody knows which signals there are.
    flat = ErrorKey(None, "MOTOR_HOT")

    assert trees({BLIND: follows(flat, severity=Severity.CRITICAL)})[BLIND].cut_sets == ((flat,),)


def test_what_leads_to_no_critical_error_is_left_out_of_the_graph() -> None:
    found = graph({LATE: follows(SILENT), BLIND: follows(DARK, severity=Severity.CRITICAL)})

    assert found.basic == (ESTOP, DARK)
    assert list(found.followed) == [BLIND]


def test_of_too_many_cut_sets_it_is_told_what_is_missing() -> None:
    inputs = [ErrorKey(LIDAR, f"CHANNEL_{number}") for number in range(10)]
    errors = {
        each: follows(*(ErrorKey(CAMERA, f"{each.error}_{cause}") for cause in range(10)))
        for each in inputs
    }
    errors[BLIND] = follows_from_all(*inputs, severity=Severity.CRITICAL)

    tree = trees(errors)[BLIND]

    assert tree.cut_sets == ()
    assert tree.problem == (
        "more than 10,000 cut sets lead to carrier.BLIND, or they take too long to find; only those"
        " of at most 4 errors are listed"
    )
    assert trees({})[ESTOP].problem is None
