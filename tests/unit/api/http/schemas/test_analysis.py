from api.http.schemas.analysis import AnalysisJson
from domain.analysis.fault_trees import FaultTree
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import PartName

BLIND = ErrorKey(PartName("carrier"), "BLIND")
SILENT = ErrorKey(PartName("lidar"), "SILENT")
ESTOP = ErrorKey(None, "ESTOP")


def test_a_fault_tree_is_shown_with_its_cut_sets_in_their_order() -> None:
    tree = FaultTree(BLIND, Severity.FATAL, False, ((ESTOP,), (SILENT, ESTOP)), None)

    (shown,) = AnalysisJson.of([tree]).model_dump(mode="json")["errors"]

    estop, silent = {"part": None, "error": "ESTOP"}, {"part": "lidar", "error": "SILENT"}
    assert shown == {
        "part": "carrier",
        "error": "BLIND",
        "severity": "fatal",
        "cut_sets": [[estop], [silent, estop]],
        "incomplete": None,
    }


def test_a_tree_with_too_many_cut_sets_says_up_to_where_it_is_complete() -> None:
    tree = FaultTree(BLIND, Severity.FATAL, False, ((ESTOP,),), 2)

    (shown,) = AnalysisJson.of([tree]).errors

    assert shown.incomplete is not None
    assert (shown.incomplete.code, shown.incomplete.complete_to) == ("TOO_MANY_CUT_SETS", 2)
    assert shown.incomplete.message == tree.problem
