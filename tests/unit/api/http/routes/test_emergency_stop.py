"""`/emergency_stop`: a latch that only a person releases."""

import pytest

from tests.support.http_robot import HttpRobot

PATH = "/emergency_stop"


async def test_a_robot_starts_with_the_emergency_stop_released(robot: HttpRobot) -> None:
    assert await robot.get(PATH) == {
        "engaged": False,
        "by": None,
        "reason": None,
        "since_at": None,
        "standstill_at": None,
        "stops": [],
        "waits_for": [],
        "not_heard": [],
    }


async def test_who_engages_it_why_and_when_is_kept(robot: HttpRobot) -> None:
    await robot.pass_time(2)

    answer = await robot.http.put(PATH, json={"engaged": True, "reason": "child on the path"})

    assert answer.status_code == 200
    assert answer.json() == {
        "engaged": True,
        "by": "http:127.0.0.1",
        "reason": "child on the path",
        "since_at": "2026-01-01T00:00:02.000Z",
        "standstill_at": None,
        "stops": [
            {
                "id": answer.json()["stops"][0]["id"],
                "device": None,
                "by": "http:127.0.0.1",
                "reason": "child on the path",
                "since_at": "2026-01-01T00:00:02.000Z",
            }
        ],
        "waits_for": [],
        "not_heard": [],
    }
    assert (await robot.get("/system_state"))["errors"] == ["ESTOP"]


async def test_to_press_twice_is_to_press_once(robot: HttpRobot) -> None:
    await robot.http.put(PATH, json={"engaged": True, "reason": "first"})
    await robot.pass_time(1)
    first = await robot.get(PATH)

    second = await robot.http.put(PATH, json={"engaged": True, "reason": "second"})

    assert (second.status_code, second.json()) == (200, first)


async def test_it_tells_when_the_vehicle_was_first_seen_to_stand_since(robot: HttpRobot) -> None:
    await robot.http.put(PATH, json={"engaged": True, "reason": "child on the path"})
    await robot.pass_time(1)

    assert (await robot.get(PATH))["standstill_at"] == "2026-01-01T00:00:00.050Z"


async def test_no_reading_releases_it_and_a_person_does(robot: HttpRobot) -> None:
    await robot.http.put(PATH, json={"engaged": True})
    await robot.http.post("/signals/estop", json={"value": False})
    await robot.pass_time(1)
    assert (await robot.get(PATH))["engaged"] is True

    answer = await robot.http.put(PATH, json={"engaged": False, "reason": "path is free"})

    assert answer.json()["engaged"] is False
    assert (await robot.get("/system_state"))["state"] == "IDLE"


async def test_a_release_ends_only_the_stop_that_somebody_saw(robot: HttpRobot) -> None:
    first = (await robot.http.put(PATH, json={"engaged": True})).json()
    await robot.http.put(PATH, json={"engaged": False})
    await robot.http.put(PATH, json={"engaged": True, "reason": "another child"})

    seen = [stop["id"] for stop in first["stops"]]
    answer = await robot.http.put(PATH, json={"engaged": False, "stops": seen})
    assert (answer.status_code, answer.json()["engaged"]) == (200, True)

    seen = [stop["id"] for stop in answer.json()["stops"]]
    answer = await robot.http.put(PATH, json={"engaged": False, "stops": seen})
    assert answer.json()["engaged"] is False


async def test_a_stop_is_taken_whatever_it_says_of_others(robot: HttpRobot) -> None:
    answer = await robot.http.put(PATH, json={"engaged": True, "stops": [{"id": 7}]})

    assert answer.json()["engaged"] is True
    assert answer.json()["ignored"][0]["pointer"] == "/stops/0"


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"engaged": False, "stops": "all"},
        {"engaged": False, "stops": ["x" * 101]},
        {"engaged": False, "stops": ["x"] * 1_001},
        {"engaged": "perhaps"},
        {"engaged": 2},
        {"engaged": None},
        {"engaged": False, "reason": "x" * 501},
        {"engaged": False, "who": "me"},
    ],
)
async def test_what_is_not_clearly_a_stop_is_refused(body: object, robot: HttpRobot) -> None:
    answer = await robot.http.put(PATH, json=body)

    assert answer.status_code == 422
    assert (await robot.get(PATH))["engaged"] is False


@pytest.mark.parametrize("count", [30, 900, 24_000])
async def test_a_body_with_many_unknown_members_gets_a_short_answer(
    count: int, robot: HttpRobot
) -> None:
    body = {f"unknown {number}": 1 for number in range(count)}

    answer = await robot.http.patch("/mock/temperature", json=body)

    assert answer.status_code in (413, 422)
    assert len(answer.content) < 5_000
