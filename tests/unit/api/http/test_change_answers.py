"""How a request for a change is answered, apart from what it does."""

import asyncio

import pytest

from api.http.change_answers import MAX_WAIT_S
from tests.support.http_robot import HttpRobot
from tests.support.manual_clock import settle

PATH = "/nodes/drive_base/mode"


async def test_the_longest_wait_is_a_minute(robot: HttpRobot) -> None:
    asked = robot.http.post(f"{PATH}?wait={MAX_WAIT_S}", json={"mode": "FAST"})

    answer = await robot.while_time_passes(5, asked)

    assert (MAX_WAIT_S, answer.status_code) == (60, 200)


async def test_who_does_not_wait_is_answered_202_also_when_nothing_is_left_to_do(
    robot: HttpRobot,
) -> None:
    await robot.bring_to("drive_base", "FAST")

    answer = await robot.http.post(PATH, json={"mode": "FAST"})

    assert (answer.status_code, answer.json()["status"]) == (202, "succeeded")


async def test_who_waits_is_told_where_the_change_is_as_well(robot: HttpRobot) -> None:
    answer = await robot.http.post(f"{PATH}?wait=0", json={"mode": "FAST"})

    assert answer.headers["location"] == f"/changes/{answer.json()['id']}"


async def test_who_waits_for_a_change_that_is_canceled_is_told_so(robot: HttpRobot) -> None:
    asked = robot.http.post(f"{PATH}?wait=30", json={"mode": "FAST"})
    waiting = asyncio.create_task(asked)
    await settle()
    await robot.http.delete(f"/changes/{robot.supervisor.core.changes()[0].id}")

    answer = await waiting

    assert (answer.status_code, answer.json()["status"]) == (409, "canceled")


@pytest.mark.parametrize("text", ["true", "1"])
async def test_a_dry_run_is_refused_as_the_change_would_be(text: str, robot: HttpRobot) -> None:
    await robot.http.put("/emergency_stop", json={"engaged": True})

    answer = await robot.http.post(f"{PATH}?dry_run={text}", json={"mode": "FAST"})

    assert (answer.status_code, answer.json()["code"]) == (409, "BLOCKED")
    assert answer.json()["blockers"]


async def test_an_unclear_dry_run_does_nothing(robot: HttpRobot) -> None:
    answer = await robot.http.post(f"{PATH}?dry_run=perhaps", json={"mode": "FAST"})

    assert answer.status_code == 422
    assert (await robot.get("/changes"))["items"] == []
