"""The fold of the stream, the reference client, in the only engine that runs it: the browser."""

from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page

pytestmark = pytest.mark.browser

AT = "2026-01-02T03:04:05.000Z"
ACTIVE = {"target": None, "actual": {"state": "active", "mode": "FAST"}, "converged": True}
LATER = "2026-01-02T03:04:09.000Z"
DEVIATING = {**ACTIVE, "converged": False}


def fold(page: Page, *messages: dict[str, Any]) -> dict[str, Any]:
    """Return the state after `messages`; the state of each step is frozen, so that it is pure."""
    state: dict[str, Any] = page.evaluate(
        """async (messages) => {
            const { emptyState, fold } = await import("/web/js/base/store.js");
            const frozen = (value) => {
                if (value && typeof value === "object") {
                    Object.values(Object.freeze(value)).forEach(frozen);
                }
                return value;
            };
            const next = (state, message) => frozen(fold(state, frozen(message)));
            return messages.reduce(next, emptyState());
        }""",
        list(messages),
    )
    return state


def current_task(page: Page, state: dict[str, Any]) -> object:
    script = 'async (state) => (await import("/web/js/base/store.js")).currentTask(state)'
    return page.evaluate(script, state)


def frame(at: str = AT, **members: object) -> dict[str, Any]:
    return {"type": "state", "at": at, "seq": 1, "skipped": 0, **members}


def test_an_error_of_a_part_is_known_until_it_is_told_to_be_normal(page: Page) -> None:
    lost = {"error": "UNREACHABLE", "part": "arm", "state": "active", "since_at": AT}
    low = {"error": "BATTERY_LOW", "part": None, "state": "active", "since_at": AT}
    told = frame(errors={"arm.UNREACHABLE": lost, "BATTERY_LOW": low})

    known = fold(page, told, frame(LATER))
    ended = fold(page, told, frame(LATER, errors={"arm.UNREACHABLE": {**lost, "state": "normal"}}))

    script = 'async (state) => (await import("/web/js/base/store.js")).errorsOf(state, "arm")'
    assert page.evaluate(script, known) == [lost]
    assert page.evaluate(script, ended) == []
    assert list(ended["errors"]) == ["BATTERY_LOW"]


def task(identity: str, **members: object) -> dict[str, Any]:
    return {"id": identity, "status": "RUNNING", "ended_at": None, **members}


def event(number: int) -> dict[str, Any]:
    return {"type": "event", "epoch": "a", "id": number, "at": AT, "kind": "x", "data": {}}


def hello(epoch: str, started_at: str = AT, boot: int = 1, newest: int = 0) -> dict[str, Any]:
    told = {"epoch": epoch, "boot": boot, "started_at": started_at, "newest": newest}
    return {"type": "hello", **told}


def test_parts_that_a_frame_leaves_out_stay_as_they_were(page: Page) -> None:
    state = fold(page, frame(parts={"a": ACTIVE, "b": ACTIVE}), frame(parts={"b": DEVIATING}))
    assert state["parts"]["a"]["converged"] is True
    assert state["parts"]["b"]["converged"] is False


def test_events_are_kept_once_though_the_log_tells_them_again(page: Page) -> None:
    state = fold(page, event(3), {"type": "log", "items": [event(1), event(2), event(3)]})
    assert [kept["id"] for kept in state["events"]] == [1, 2, 3]
    assert state["lastEventId"] == 3


def test_missing_events_leave_a_note(page: Page) -> None:
    state = fold(page, event(1), {"type": "gap", "from": 2, "to": 7}, event(8))
    notes = [kept["note"] for kept in state["events"] if "note" in kept]
    assert notes == ["Events 2 to 7 are missing here."]
    assert state["lastEventId"] == 8


def test_task_and_vehicle_stay_as_they_were_while_frames_leave_them_out(page: Page) -> None:
    state = fold(page, frame(task=task("t1"), vehicle={"at": AT}), frame())
    assert state["task"]["id"] == "t1"
    assert state["vehicle"] == {"at": AT}


def test_a_task_that_ended_stays_until_the_next_and_is_not_the_current_one(page: Page) -> None:
    ended = task("t1", status="SUCCEEDED", ended_at=AT)
    driven = fold(page, frame(task=task("t1")))
    over = fold(page, frame(task=task("t1")), frame(task=ended), frame())
    assert over["task"] == ended
    assert current_task(page, driven) == driven["task"]
    assert current_task(page, over) is None
    assert current_task(page, fold(page, frame(task=None))) is None


def test_holds_are_those_of_the_last_frame_that_told_them(page: Page) -> None:
    hold = {"owner": "operator", "reason": "", "by": "", "since_at": AT}
    held, free = frame(holds={"operator": hold}), frame(holds={})
    assert fold(page, held, frame())["holds"] == {"operator": hold}
    assert fold(page, held, free)["holds"] == {}


def test_the_stop_is_that_of_the_last_frame_or_of_the_press_that_was_answered(page: Page) -> None:
    released = {"engaged": False, "since_at": None}
    engaged = {"engaged": True, "since_at": LATER}
    pressed = {"type": "latch", "latch": engaged}
    assert fold(page, frame(emergency_stop=released), frame())["emergencyStop"] == released
    assert fold(page, frame(emergency_stop=released), pressed)["emergencyStop"] == engaged
    # A frame that was on its way tells of the time before the press.
    assert fold(page, pressed, frame(emergency_stop=released))["emergencyStop"] == engaged
    later = frame(LATER, emergency_stop=released)
    assert fold(page, pressed, later)["emergencyStop"] == released


def test_an_answer_to_the_press_that_comes_after_the_standstill_does_not_hide_it(
    page: Page,
) -> None:
    engaged = {"engaged": True, "since_at": AT, "standstill_at": None}
    stands = engaged | {"standstill_at": LATER}
    pressed = {"type": "latch", "latch": engaged}
    assert fold(page, frame(LATER, emergency_stop=stands), pressed)["emergencyStop"] == stands
    released = {"engaged": False, "since_at": LATER, "standstill_at": None}
    assert fold(page, frame(LATER, emergency_stop=released), pressed)["emergencyStop"] == released


def test_when_the_service_was_restarted_is_told_until_it_is_read(page: Page) -> None:
    first, second = hello("a"), hello("b", LATER)
    assert fold(page, first, first)["restartedAt"] is None
    assert fold(page, first, second)["restartedAt"] == LATER
    assert fold(page, first, second, {"type": "restart_read"})["restartedAt"] is None


def test_after_a_restart_nothing_old_is_shown_but_the_events(page: Page) -> None:
    state = fold(page, hello("a"), frame(parts={"a": ACTIVE}), event(9), hello("b"), event(1))
    assert state["parts"] == {}
    assert [kept["id"] for kept in state["events"]] == [9, "restart-b", 1]


def test_where_runs_are_kept_events_go_on_over_a_restart(page: Page) -> None:
    begun = (hello("a"), event(9), hello("b", boot=2, newest=12))
    state = fold(page, *begun, event(9), event(10), event(11))
    assert [kept["id"] for kept in state["events"]] == [9, 10, 11]
    assert fold(page, *begun)["lastEventId"] == 9


def test_events_before_the_greeting_are_not_asked_for_again(page: Page) -> None:
    assert fold(page, hello("a", newest=7))["lastEventId"] == 7


def test_earlier_events_are_put_before_with_what_is_missing(page: Page) -> None:
    gaps = [{"from": 3, "to": 7}]
    earlier = {"type": "earlier", "items": [event(2), event(8)], "gaps": gaps, "oldest": 2}
    state = fold(page, event(9), earlier)
    assert [kept["id"] for kept in state["events"]] == [2, "gap-3", 8, 9]
    assert (state["oldestEventId"], state["eventsKept"]) == (2, 203)


def test_a_gap_without_an_end_is_of_a_run_that_the_service_does_not_know(page: Page) -> None:
    gap = {"type": "gap", "from": 10, "to": None, "epoch": "a"}
    state = fold(page, event(9), gap, event(1))
    assert [kept["id"] for kept in state["events"]] == [9, "gap-10", 1]
