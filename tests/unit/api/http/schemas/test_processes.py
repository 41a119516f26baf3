"""The process of a node, as a client sees it."""

from api.http.schemas.processes import ProcessJson
from domain.process_terms import ProcessExit, ProcessState
from domain.processes.process_view import ProcessView
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.ports import ProcessOutput
from tests.support.manual_clock import ManualClock

BASE = PartName("drive_base")


def test_a_process_that_crashed_is_shown_with_its_end_and_its_last_words() -> None:
    view = ProcessView(
        BASE,
        ProcessState.WAITING,
        None,
        None,
        seconds(3),
        4,
        ProcessExit(signal="SIGSEGV"),
        seconds(2),
    )

    shown = ProcessJson.of(view, ProcessOutput((), ("ready", "oops")), ManualClock())

    assert (shown.state, shown.pid, shown.starts_left, shown.output) == ("waiting", None, 4, [])
    assert shown.next_start_at is not None
    assert shown.exit is not None
    assert shown.exit.model_dump(exclude={"at"}) == {
        "code": None,
        "signal": "SIGSEGV",
        "reason": "ended by SIGSEGV",
        "output": ["ready", "oops"],
    }


def test_a_process_that_never_ended_has_no_end() -> None:
    view = ProcessView(BASE, ProcessState.RUNNING, 4711, seconds(1), None, 4, None, None)

    shown = ProcessJson.of(view, ProcessOutput(("ready",), ()), ManualClock())

    assert (shown.pid, shown.exit, shown.output) == (4711, None, ["ready"])
