"""Bodies are read as JSON, whatever the client calls them, up to a limit."""

from collections.abc import AsyncIterator

import pytest

from api.http.limits import USUAL_LIMITS
from tests.support.http_robot import HttpRobot

PATH = "/emergency_stop"
PRESS = '{"engaged": true}'


@pytest.mark.parametrize("content_type", ["application/x-www-form-urlencoded", "text/csv", "x", ""])
async def test_any_type_will_do_for_who_is_no_page(content_type: str, robot: HttpRobot) -> None:
    headers = {"content-type": content_type}

    assert (await robot.http.put(PATH, content=PRESS, headers=headers)).status_code == 200


async def test_no_type_will_do_as_well(robot: HttpRobot) -> None:
    async def chunks() -> AsyncIterator[bytes]:
        yield PRESS.encode()

    assert (await robot.http.put(PATH, content=chunks())).status_code == 200


async def test_a_body_whose_length_nobody_told_is_counted_as_it_comes(robot: HttpRobot) -> None:
    async def chunks() -> AsyncIterator[bytes]:
        for _ in range(10):
            yield b" " * (USUAL_LIMITS.json_bytes // 8)

    answer = await robot.http.put(PATH, content=chunks())

    assert (answer.status_code, answer.json()["code"]) == (413, "TOO_LARGE")


async def test_a_body_of_just_the_limit_is_read(robot: HttpRobot) -> None:
    body = PRESS + " " * (USUAL_LIMITS.json_bytes - len(PRESS))

    assert (await robot.http.put(PATH, content=body)).status_code == 200


@pytest.mark.parametrize("body", [b"{", b"[" * 100_000, b"\xff", b'{"engaged": true}x'])
async def test_what_is_no_json_is_malformed(body: bytes, robot: HttpRobot) -> None:
    answer = await robot.http.put(PATH, content=body)

    assert (answer.status_code, answer.json()["code"]) == (400, "MALFORMED")


async def test_no_body_at_all_is_an_invalid_one(robot: HttpRobot) -> None:
    answer = await robot.http.put(PATH)

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_BODY")
