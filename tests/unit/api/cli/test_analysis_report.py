from api.cli.analysis_report import MAX_LINES, report_lines
from domain.analysis.fault_trees import FaultTree
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import PartName

BLIND = ErrorKey(PartName("carrier"), "BLIND")
STUCK = ErrorKey(PartName("carrier"), "STUCK")
LATE = ErrorKey(PartName("mapper"), "LATE")
SILENT = ErrorKey(PartName("lidar"), "SILENT")
ESTOP = ErrorKey(None, "ESTOP")


def tree(
    key: ErrorKey, *cut_sets: tuple[ErrorKey, ...], complete_to: int | None = None
) -> FaultTree:
    return FaultTree(key, Severity.CRITICAL, cut_sets == ((key,),), cut_sets, complete_to)


def test_errors_with_single_points_of_failure_come_first() -> None:
    trees = [
        tree(ESTOP, (ESTOP,)),
        tree(STUCK, (LATE, SILENT)),
        tree(BLIND, (LATE,), (SILENT, ESTOP)),
    ]

    assert list(report_lines("robot.yaml", trees)) == [
        "Fault trees of robot.yaml",
        "  3 critical or fatal errors; 2 of them follow from others, 1 of these from a single one",
        "",
        "carrier.BLIND (critical): 2 minimal cut sets",
        "  single points of failure:",
        "    mapper.LATE",
        "  2 errors together:",
        "    lidar.SILENT + ESTOP",
        "",
        "carrier.STUCK (critical): 1 minimal cut set",
        "  2 errors together:",
        "    mapper.LATE + lidar.SILENT",
        "",
        "Detected, reported or built in, so that no other error leads to them:",
        "  ESTOP (critical)",
    ]


def test_a_model_whose_errors_follow_from_no_others_has_a_short_report() -> None:
    lines = list(report_lines("robot.yaml", [tree(ESTOP, (ESTOP,))]))

    assert lines[1] == "  1 critical or fatal error; none follows from others"


def test_of_too_many_cut_sets_the_report_says_what_is_missing() -> None:
    *_, number, problem = report_lines("robot.yaml", [tree(BLIND, complete_to=4)])

    assert number == "carrier.BLIND (critical): too many minimal cut sets, 0 of which are known"
    assert problem == (
        "  TOO_MANY_CUT_SETS: more than 10,000 cut sets lead to carrier.BLIND, or they take too"
        " long to find; only those of at most 4 errors are listed"
    )


def test_a_long_list_is_cut_short() -> None:
    causes = [ErrorKey(PartName("lidar"), f"E{number}") for number in range(MAX_LINES + 7)]

    lines = list(report_lines("robot.yaml", [tree(BLIND, *((cause,) for cause in causes))]))

    assert lines[-1] == "    and 7 more, which --format json lists"
    assert sum(line.startswith("    lidar.") for line in lines) == MAX_LINES
