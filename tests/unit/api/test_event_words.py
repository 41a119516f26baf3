from typing import Any

import pytest

from api.event_words import event_words
from domain.events import Event
from tests.support.scenarios import ALL_GOOD, NEVER_STALE, STRAIGHT, Step, happened

SYSTEMS = {"actuation"}


def told(kind: str, **data: Any) -> str | None:  # noqa: ANN401
    return event_words(Event(1, 0, kind, None, "test", data), SYSTEMS)


@pytest.mark.parametrize(
    ("kind", "data", "words"),
    [
        (
            "system_state.changed",
            {"state": "ERROR", "was": "IDLE", "errors": ["ESTOP", "GPS_LOST"]},
            "IDLE -> ERROR: ESTOP, GPS_LOST",
        ),
        ("system_state.changed", {"state": "IDLE", "was": "ERROR", "errors": []}, "ERROR -> IDLE"),
        (
            "system_state.changed",
            {"state": "ERROR", "was": "ERROR", "errors": ["ESTOP"]},
            "ERROR: ESTOP",
        ),
        ("error.raised", {"error": "ESTOP", "message": "it is pressed"}, "ESTOP: it is pressed"),
        ("error.cleared", {"error": "ESTOP"}, "ESTOP is over"),
        (
            "part.actual_changed",
            {"part": "actuation", "was": "inactive", "actual": "active.FAST"},
            "actuation: inactive -> active.FAST",
        ),
        (
            "change.failed",
            {"part": "arm", "reason": "arm refused"},
            "arm: change failed: arm refused",
        ),
        ("change.succeeded", {"part": "arm", "reason": None}, "arm: change succeeded"),
        ("task.served", {"task": "t1", "length_m": 20.04}, "task t1 is served, 20.0 m"),
        ("task.pausing", {"task": "t1", "reason": "lunch"}, "task t1 stops: lunch"),
        (
            "task.aborted",
            {"task": "t1", "reason": "off the path", "progress": 0.418},
            "task t1 is given up at 42%: off the path",
        ),
        ("hold.set", {"owner": "operator", "reason": ""}, "hold of operator"),
        ("emergency_stop.engaged", {"reason": "a child"}, "emergency stop engaged: a child"),
    ],
)
def test_what_an_operator_needs_is_told_in_words(
    kind: str, data: dict[str, Any], words: str
) -> None:
    assert told(kind, **data) == words


def test_what_only_the_program_needs_is_left_out() -> None:
    assert told("signal.pending", signal="gps_accuracy", error="GPS_LOST") is None
    assert told("part.actual_changed", part="arm", was="inactive", actual="active") is None


def test_a_node_that_is_back_is_told_with_what_becomes_of_it() -> None:
    back = {"node": "drive_base", "target": "active.FAST"}

    assert told("node.restoring", **back) == "drive_base is back, and restored to active.FAST"
    words = told("node.not_restored", **back, reason="ESTOP is on")
    assert words == "drive_base is back, not restored: ESTOP is on"


def test_the_words_fit_all_that_really_happens() -> None:
    def ask(t_s: float, method: str, path: str, **body: object) -> Step:
        return {"t_s": t_s, "request": {"method": method, "path": path, "body": body}}

    simulation = happened(
        ALL_GOOD,
        {"t_s": 1, "change": {"part": "actuation", "mode": "PERFORMANCE"}},
        {"t_s": 2, "task": {"waypoints": STRAIGHT}},
        ask(3, "PUT", "/emergency_stop", engaged=True, reason="a child"),
        ask(5, "PUT", "/emergency_stop", engaged=False),
        ask(6, "PUT", "/holds/operator", reason="lunch"),
        ask(7, "DELETE", "/holds/operator"),
        {"t_s": 8, "change": {"part": "drive_base", "mode": "SLOW"}},
        {"t_s": 8, "node": "drive_base", "fault": "die"},
        {"t_s": 9, "task": {"waypoints": STRAIGHT, "start_index": 8}},
        {"t_s": 10, "task": None},
        {"t_s": 11, "task": {"waypoints": STRAIGHT, "start_index": 9}},
        until_s=40,
        robot=NEVER_STALE,
    )

    words = {event.kind: event_words(event, SYSTEMS) for event in simulation.events}

    assert simulation.refusals == []
    assert {"task.succeeded", "task.canceled", "node.unreachable", "change.failed"} <= set(words)
    assert words["task.succeeded"] is not None
    assert words["task.succeeded"].startswith("task t3 has succeeded at 100%")
