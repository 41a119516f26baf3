"""All kinds of events: each describes itself, and its words fit what really happens."""

from dataclasses import fields

import pytest

from domain.events.event import Event
from domain.events.kinds import EVENTS
from tests.support.scenarios import ALL_GOOD, NEVER_STALE, STRAIGHT, Step, happened


@pytest.mark.parametrize("kind", EVENTS.values(), ids=EVENTS)
def test_every_kind_describes_itself(kind: type[Event]) -> None:
    assert kind.__doc__, "the reference of events begins with it"
    assert kind.optional <= {item.name for item in fields(kind)}  # type: ignore[arg-type]
    assert kind.hidden <= {item.name for item in fields(kind)}  # type: ignore[arg-type]
    assert kind._words is not Event._words, "every event has words of its own"  # noqa: SLF001


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

    words = {item.kind: item.event.words for item in simulation.events}

    assert simulation.refusals == []
    assert {"task.succeeded", "task.canceled", "node.unreachable", "change.timed_out"} <= set(words)
    assert words["task.succeeded"].startswith("task t3 succeeded at 100%")
    assert all(words.values())
