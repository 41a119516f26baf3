"""The fold of the stream, the reference client, in the only engine that runs it: the browser."""

from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Page

from tests.browser.station import Service

pytestmark = pytest.mark.browser

AT = "2026-01-02T03:04:05.000Z"
ACTIVE = {"target": None, "actual": {"state": "active", "mode": "FAST"}, "converged": True}
DEVIATING = {**ACTIVE, "converged": False}


@pytest.fixture(scope="module")
def page(browser: Browser, running_service: Service) -> Iterator[Page]:
    page = browser.new_page()
    page.goto(running_service.url)
    yield page
    page.close()


def fold(page: Page, *messages: dict[str, Any]) -> dict[str, Any]:
    """Return the state after `messages`; the state of each step is frozen, so that it is pure."""
    state: dict[str, Any] = page.evaluate(
        """async (messages) => {
            const { emptyState, fold } = await import("/web/js/store.js");
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


def frame(at: str = AT, **members: object) -> dict[str, Any]:
    return {"type": "state", "at": at, "seq": 1, "skipped": 0, **members}


def task(identity: str, **members: object) -> dict[str, Any]:
    return {"id": identity, "status": "RUNNING", "ended_at": None, **members}


def event(number: int) -> dict[str, Any]:
    return {"type": "event", "epoch": "a", "id": number, "at": AT, "kind": "x", "data": {}}


def test_parts_that_a_frame_leaves_out_stay_as_they_were(page: Page) -> None:
    state = fold(page, frame(parts={"a": ACTIVE, "b": ACTIVE}), frame(parts={"b": DEVIATING}))
    assert state["parts"]["a"]["converged"] is True
    assert state["parts"]["b"]["converged"] is False


def test_an_answer_to_a_request_never_takes_a_part_back_behind_the_stream(page: Page) -> None:
    old = {"name": "a", "kind": "node", "reachable": False, "change": None, **DEVIATING}
    new = {"name": "a", "kind": "node", "reachable": True, "change": "c2", **ACTIVE}
    state = fold(page, frame(parts={"a": new}), {"type": "structure", "items": [old]})
    streamed = fold(page, frame(parts={"a": new}))
    assert state["parts"] == streamed["parts"]


def test_an_answer_tells_of_parts_that_no_frame_has_told_yet(page: Page) -> None:
    told = {"name": "b", "kind": "node", "reachable": True, "change": None, **ACTIVE}
    state = fold(page, {"type": "structure", "items": [told]})
    assert state["parts"] == {"b": told}


def test_a_deviation_is_as_old_as_the_first_frame_that_tells_it(page: Page) -> None:
    later = "2026-01-02T03:04:09.000Z"
    state = fold(page, frame(parts={"a": DEVIATING}), frame(later, parts={"a": DEVIATING}))
    assert state["parts"]["a"]["deviation_since_at"] == AT


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


def test_a_task_that_is_no_longer_the_current_one_is_the_last(page: Page) -> None:
    state = fold(page, frame(task=task("t1")), frame(task=task("t2")), frame(task=None))
    assert state["task"] is None
    assert state["lastTask"]["id"] == "t2"


def test_that_there_is_still_no_task_does_not_make_one_forget_how_the_last_ended(
    page: Page,
) -> None:
    ended = task("t1", status="SUCCEEDED", ended_at=AT)
    state = fold(
        page,
        frame(task=task("t1")),
        frame(task=None),
        {"type": "ended_task", "task": ended},
        frame(task=None),
    )
    assert state["lastTask"] == ended


def test_holds_are_those_of_the_last_answer(page: Page) -> None:
    hold = {"owner": "operator", "reason": "", "by": "", "since_at": AT}
    first, second = {"type": "holds", "items": [hold]}, {"type": "holds", "items": []}
    assert fold(page, first)["holds"] == [hold]
    assert fold(page, first, second)["holds"] == []


def test_after_a_restart_nothing_old_is_shown_but_the_events(page: Page) -> None:
    first, second = ({"type": "hello", "epoch": epoch} for epoch in "ab")
    state = fold(page, first, frame(parts={"a": ACTIVE}), event(9), second, event(1))
    assert state["parts"] == {}
    assert [kept["id"] for kept in state["events"]] == [9, "restart-b", 1]
