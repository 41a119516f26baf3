"""`/holds` as an operator uses it."""

import pytest

from tests.support.http_robot import HttpRobot

CSV = {"Content-Type": "text/csv"}
LINE = "".join(f"{x},0,0\n" for x in range(11))


async def test_a_hold_is_shown_with_owner_reason_and_time(robot: HttpRobot) -> None:
    await robot.pass_time(1)
    answer = await robot.http.put("/holds/operator", json={"reason": "loading"})
    shown = {
        "owner": "operator",
        "reason": "loading",
        "by": "http:127.0.0.1",
        "since_at": "2026-01-01T00:00:01.000Z",
    }

    assert (answer.status_code, answer.json()) == (200, shown)
    assert (await robot.get("/holds"))["items"] == [shown]


async def test_a_hold_stops_the_task_and_its_release_lets_it_go_on(robot: HttpRobot) -> None:
    await robot.http.post("/tasks", content=LINE, headers=CSV)
    await robot.pass_time(2)
    await robot.http.put("/holds/operator", json={"reason": "loading"})
    held = await robot.get("/tasks/current")
    assert (held["status"], held["reason"]) == ("PAUSING", "loading")
    assert (await robot.http.delete("/holds/operator")).status_code == 204

    assert (await robot.get("/tasks/current"))["status"] == "RUNNING"


async def test_a_hold_needs_no_body(robot: HttpRobot) -> None:
    answer = await robot.http.put("/holds/gate-7")

    assert (answer.status_code, answer.json()["reason"]) == (200, "")


async def test_null_is_as_no_body(robot: HttpRobot) -> None:
    null = await robot.http.put("/holds/gate", content="null")

    assert (null.status_code, null.json()["reason"]) == (200, "")
    assert "ignored" not in null.json()


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ('{"reason":"loading","reason":"x"}', "loading"),
        ('{"reason":"loading","by":{"of":1,"of":2}}', "loading"),
        ('{"reason":17}', ""),
        ('{"reason":"' + "x" * 501 + '"}', "x" * 500),
        ("[]", ""),
        ("{", ""),
        ("reason=loading", ""),
        ("{" + ",".join(f'"m{number}":1' for number in range(1_500)) + "}", ""),
        (b"\xff", ""),
        ('{"reason":"\\ud800"}', "?"),
    ],
    ids=range(10),
)
async def test_a_hold_is_set_whatever_is_in_the_body(
    robot: HttpRobot, body: str | bytes, reason: str
) -> None:
    answer = await robot.http.put("/holds/gate", content=body)

    assert (answer.status_code, answer.json()["reason"]) == (200, reason)
    assert answer.json()["ignored"]
    assert "gate" in robot.supervisor.core.driving.holds


async def test_releasing_what_is_not_held_is_right(robot: HttpRobot) -> None:
    assert (await robot.http.delete("/holds/operator")).status_code == 204


@pytest.mark.parametrize("owner", ["error", "vehicle"])
async def test_the_holds_of_pilothouse_are_refused_to_others(robot: HttpRobot, owner: str) -> None:
    put = await robot.http.put(f"/holds/{owner}", json={"reason": "x"})
    deleted = await robot.http.delete(f"/holds/{owner}")

    assert (put.status_code, deleted.status_code) == (409, 409)
    assert put.json()["code"] == "RESERVED_HOLD"


@pytest.mark.parametrize("owner", ["%20", "a" * 65, "-x", "a%2Fb"])
async def test_a_name_that_is_none_is_refused(robot: HttpRobot, owner: str) -> None:
    assert (await robot.http.put(f"/holds/{owner}")).status_code in (404, 422)


async def test_there_is_a_bound_on_their_number(robot: HttpRobot) -> None:
    answers = [await robot.http.put(f"/holds/o{number}") for number in range(65)]

    assert [answer.status_code for answer in answers[-2:]] == [200, 409]
    assert answers[-1].json()["code"] == "TOO_MANY_HOLDS"
