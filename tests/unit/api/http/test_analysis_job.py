import json
import pickle

from api.http.analysis_job import analyse
from domain.analysis.fault_trees import Causes, ErrorGraph
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import PartName

BLIND = ErrorKey(PartName("carrier"), "BLIND")
SILENT = ErrorKey(PartName("lidar"), "SILENT")
ESTOP = ErrorKey(None, "ESTOP")


def graph(causes: tuple[ErrorKey, ...], *, need_all: bool) -> ErrorGraph:
    return ErrorGraph({BLIND: Severity.FATAL}, {BLIND: Causes(causes, need_all)}, causes)


def test_an_error_is_shown_with_all_sets_that_raise_it() -> None:
    shown = json.loads(analyse(graph((ESTOP, SILENT), need_all=False)))

    assert shown["errors"] == [
        {
            "part": "carrier",
            "error": "BLIND",
            "severity": "fatal",
            "cut_sets": [
                [{"part": None, "error": "ESTOP"}],
                [{"part": "lidar", "error": "SILENT"}],
            ],
            "incomplete": None,
        }
    ]


def test_of_too_many_sets_it_is_shown_which_are_there() -> None:
    causes = tuple(ErrorKey(None, f"CHANNEL_{number}") for number in range(10))
    basic = [tuple(ErrorKey(None, f"{each.error}_{n}") for n in range(10)) for each in causes]
    followed = {
        each: Causes(below, need_all=False) for each, below in zip(causes, basic, strict=True)
    }
    top = ErrorGraph(
        {BLIND: Severity.FATAL},
        {BLIND: Causes(causes, need_all=True), **followed},
        tuple(key for below in basic for key in below),
    )

    (error,) = json.loads(analyse(top))["errors"]

    assert error["cut_sets"] == []
    assert error["incomplete"]["code"] == "TOO_MANY_CUT_SETS"
    assert error["incomplete"]["complete_to"] == 4


def test_a_graph_can_be_sent_to_the_process_that_analyses_it() -> None:
    sent = graph((ESTOP, SILENT), need_all=True)

    assert pickle.loads(pickle.dumps(sent)) == sent
