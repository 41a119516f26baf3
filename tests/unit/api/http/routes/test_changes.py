"""`/changes` as an operator uses it."""

import pytest

from domain.snapshot import ChangeView
from domain.state_and_mode import PartName
from tests.support.http_robot import HttpRobot

CHANGE_FIELDS = {
    "id",
    "part",
    "request",
    "status",
    "reason",
    "steps",
    "started_at",
    "ended_at",
    "cause",
    "stage",
    "deadline_at",
    "rollback",
}


async def test_a_change_is_shown_with_its_steps_and_their_times(robot: HttpRobot) -> None:
    answer = await robot.http.post("/nodes/drive_base/state", json={"transition": "configure"})
    await robot.pass_time(1)

    change = await robot.get(answer.headers["location"])

    assert set(change) == CHANGE_FIELDS
    assert change["request"] == {"transition": "configure"}
    assert change["steps"] == [
        {
            "node": "drive_base",
            "action": "configure",
            "status": "succeeded",
            "started_at": "2026-01-01T00:00:00.000Z",
            "ended_at": "2026-01-01T00:00:00.300Z",
            "error": None,
            "stage": 0,
            "after": [],
            "expected_s": 0.3,
            "rollback": False,
        }
    ]
    assert change["ended_at"] == "2026-01-01T00:00:00.300Z"


async def test_the_newest_change_comes_first(robot: HttpRobot) -> None:
    for mode in ("SLOW", "FAST", "SLOW"):
        await robot.http.post("/nodes/drive_base/mode", json={"mode": mode})

    ids = [item["id"] for item in (await robot.get("/changes"))["items"]]
    newest = [item["id"] for item in (await robot.get("/changes?limit=2"))["items"]]

    assert len(ids) == 3
    assert newest == ids[:2]
    assert ids == sorted(ids, reverse=True)


async def test_the_changes_of_one_part_are_listed_alone(robot: HttpRobot) -> None:
    await robot.bring_to("drive_base", "SLOW")
    await robot.bring_to("manipulator", "WEAK")
    await robot.bring_to("drive_base", "FAST")

    found = (await robot.get("/changes?part=drive_base"))["items"]
    newest = (await robot.get("/changes?part=drive_base&limit=1"))["items"]

    assert [item["request"]["mode"] for item in found] == ["FAST", "SLOW"]
    assert newest == found[:1]


async def test_a_part_without_changes_has_none_and_one_that_there_is_not_is_not_found(
    robot: HttpRobot,
) -> None:
    unknown = await robot.http.get("/changes?part=wings")

    assert (await robot.get("/changes?part=actuation"))["items"] == []
    assert (unknown.status_code, unknown.json()["code"]) == (404, "UNKNOWN_PART")


async def test_no_more_changes_are_shown_to_the_list_than_are_listed(
    robot: HttpRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int | None] = []
    changes = robot.supervisor.core.changes

    def counted(limit: int | None = None, part: PartName | None = None) -> tuple[ChangeView, ...]:
        asked.append(limit)
        return changes(limit, part)

    monkeypatch.setattr(robot.supervisor.core, "changes", counted)

    await robot.get("/changes?limit=2")

    assert asked == [2]


async def test_a_canceled_change_begins_no_further_step_and_leaves_the_target(
    robot: HttpRobot,
) -> None:
    answer = await robot.http.post("/nodes/drive_base/mode", json={"mode": "FAST"})

    canceled = await robot.http.delete(answer.headers["location"])

    await robot.pass_time(5)
    assert (canceled.status_code, canceled.json()["status"]) == (200, "canceled")
    part = await robot.get("/nodes/drive_base")
    assert part["actual"]["state"] == "inactive"
    assert part["target"] == {"state": "active", "mode": "FAST"}


async def test_a_change_that_has_ended_stays_as_it_ended(robot: HttpRobot) -> None:
    await robot.bring_to("drive_base", "FAST")
    (change,) = (await robot.get("/changes"))["items"]

    answer = await robot.http.delete(f"/changes/{change['id']}")

    assert (answer.status_code, answer.json()) == (200, change)


async def test_a_change_that_never_was_is_not_found(robot: HttpRobot) -> None:
    shown = await robot.http.get("/changes/c99")
    canceled = await robot.http.delete("/changes/c99")

    assert (shown.status_code, shown.json()["code"]) == (404, "UNKNOWN_CHANGE")
    assert (canceled.status_code, canceled.json()["code"]) == (404, "UNKNOWN_CHANGE")


async def test_a_list_without_bounds_is_not_given(robot: HttpRobot) -> None:
    assert (await robot.http.get("/changes?limit=1001")).status_code == 422
    assert (await robot.http.get("/changes?limit=0")).status_code == 422
