"""How an error is announced: each state with each thing that can happen, as a table."""

import pytest

from domain.health.alarm import QUIET, Alarm, Evidence
from domain.snapshot import ErrorState

S = ErrorState

NOTHING, PENDING = Evidence(S.NORMAL), Evidence(S.PENDING)
CAUSE, LINGERS, LATCH = Evidence(S.ACTIVE), Evidence(S.ACTIVE, lingers=True), Evidence(S.LATCHED)

ALARMS = {
    "normal": QUIET,
    "pending": Alarm(PENDING),
    "pending anew": Alarm(PENDING, unseen=True, raised=1, ended=2),
    "active": Alarm(CAUSE, unseen=True, raised=1),
    "active, gone": Alarm(LINGERS, unseen=True, raised=1, ended=2),
    "acknowledged": Alarm(CAUSE, raised=1),
    "acknowledged, gone": Alarm(LINGERS, raised=1, ended=2),
    "latched": Alarm(LATCH, unseen=True, raised=1, ended=2),
    "returned": Alarm(NOTHING, unseen=True, raised=1, ended=2),
}
"""`gone`: its cause is gone, and it is on for its minimum time; `anew`: pending, and unseen since
an earlier time."""

TABLE = """
recovery    | state              | pends        | cause  | lingers            | source latches | ends     | acknowledged
automatic   | normal             | pending      | active | active, gone       | latched        | normal   | normal
automatic   | pending            | pending      | active | active, gone       | latched        | normal   | pending
automatic   | pending anew       | pending anew | active | active, gone       | latched        | returned | pending
automatic   | active             | pending anew | active | active, gone       | latched        | returned | acknowledged
automatic   | active, gone       | pending anew | active | active, gone       | latched        | returned | acknowledged, gone
automatic   | acknowledged       | pending      | acknowledged | acknowledged, gone | latched  | normal   | acknowledged
automatic   | acknowledged, gone | pending      | active | acknowledged, gone | latched        | normal   | acknowledged, gone
automatic   | latched            | pending anew | active | active, gone       | latched        | returned | normal
automatic   | returned           | pending anew | active | active, gone       | latched        | returned | normal
acknowledge | normal             | pending      | active | active, gone       | latched        | normal   | normal
acknowledge | pending            | pending      | active | active, gone       | latched        | normal   | pending
acknowledge | pending anew       | pending anew | active | active, gone       | latched        | returned | pending
acknowledge | active             | latched      | active | active, gone       | latched        | latched  | acknowledged
acknowledge | active, gone       | latched      | active | active, gone       | latched        | latched  | acknowledged, gone
acknowledge | acknowledged       | pending      | acknowledged | acknowledged, gone | latched  | normal   | acknowledged
acknowledge | acknowledged, gone | pending      | active | acknowledged, gone | latched        | normal   | acknowledged, gone
acknowledge | latched            | latched      | active | active, gone       | latched        | latched  | normal
acknowledge | returned           | pending anew | active | active, gone       | latched        | returned | normal
"""  # noqa: E501 - a table is read by its columns

EVIDENCE = {
    "pends": PENDING,
    "cause": CAUSE,
    "lingers": LINGERS,
    "source latches": LATCH,
    "ends": NOTHING,
}


def rows() -> list[tuple[str, str, str, str]]:
    """Return recovery, state, what happens, and the state that follows."""
    head, *body = [
        [cell.strip() for cell in line.split("|")] for line in TABLE.strip().splitlines()
    ]
    return [
        (line[0], line[1], event, state)
        for line in body
        for event, state in zip(head[2:], line[2:], strict=True)
    ]


def name_of(alarm: Alarm) -> str:
    """Return the name of an alarm in the table, whatever its times."""
    (name,) = [
        name
        for name, known in ALARMS.items()
        if (known.found, known.unseen) == (alarm.found, alarm.unseen)
    ]
    return name


@pytest.mark.parametrize(("recovery", "state", "event", "then"), rows())
def test_what_follows_is_what_the_table_says(
    recovery: str, state: str, event: str, then: str
) -> None:
    alarm = ALARMS[state]
    if event == "acknowledged":
        after = alarm.acknowledged()
    else:
        after = alarm.after(EVIDENCE[event], 3, 4, latches=recovery == "acknowledge")
    assert name_of(after) == then


def test_the_table_is_complete() -> None:
    assert len({row[:3] for row in rows()}) == len(rows()) == 2 * len(ALARMS) * 6


@pytest.mark.parametrize(
    ("alarm", "state"),
    [
        ("normal", S.NORMAL),
        ("pending", S.PENDING),
        ("pending anew", S.PENDING),
        ("active", S.ACTIVE),
        ("active, gone", S.ACTIVE),
        ("acknowledged", S.ACKNOWLEDGED),
        ("acknowledged, gone", S.ACKNOWLEDGED),
        ("latched", S.LATCHED),
        ("returned", S.RETURNED),
    ],
)
def test_operators_see_six_states(alarm: str, state: ErrorState) -> None:
    assert ALARMS[alarm].state is state


def test_an_error_tells_when_it_was_raised_and_when_its_cause_was_gone() -> None:
    alarm = QUIET.after(CAUSE, 3, 3, latches=False)
    alarm = alarm.after(LINGERS, 9, 5, latches=False)
    alarm = alarm.after(NOTHING, 9, 7, latches=False)
    assert (alarm.state, alarm.raised, alarm.ended) == (S.RETURNED, 3, 5)
    again = alarm.after(CAUSE, 11, 11, latches=False)
    assert (again.raised, again.ended) == (11, None)
