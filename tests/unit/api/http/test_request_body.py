"""Bodies are read as JSON, whatever the client calls them, up to a limit."""

from collections.abc import AsyncIterator

import pytest
from fastapi import Request
from starlette.types import Message

from api.http.body_parsing import BodyTooLargeError
from api.http.limits import USUAL_LIMITS, ServiceLimits
from api.http.request_body import read_body
from tests.support.http_robot import HttpRobot, http_robot, http_scope

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


@pytest.mark.parametrize("body", [b"{", b"[" * 100_000, b"\xff", b'{"engaged": false}x'])
async def test_what_is_no_json_is_malformed(body: bytes, robot: HttpRobot) -> None:
    answer = await robot.http.put(PATH, content=body)

    assert (answer.status_code, answer.json()["code"]) == (400, "MALFORMED")


async def test_no_body_at_all_is_an_invalid_one(robot: HttpRobot) -> None:
    answer = await robot.http.put(PATH)

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_BODY")


class Body:
    """A body in two parts, which tells whether anybody read it."""

    def __init__(self) -> None:
        self.parts = [b"abc", b"de"]

    async def receive(self) -> Message:
        part = self.parts.pop(0)
        return {"type": "http.request", "body": part, "more_body": bool(self.parts)}


def request_of(body: Body, **headers: str) -> Request:
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    return Request(http_scope("POST", "/", **named), body.receive)


@pytest.mark.parametrize("headers", [{}, {"content_length": "5"}, {"content_length": "what?"}])
async def test_a_body_up_to_the_limit_is_read(headers: dict[str, str]) -> None:
    assert await read_body(request_of(Body(), **headers), 5) == b"abcde"


async def test_a_body_that_says_that_it_is_too_long_is_not_read_at_all() -> None:
    body = Body()

    with pytest.raises(BodyTooLargeError, match="larger than 4 bytes"):
        await read_body(request_of(body, content_length="5"), 4)
    assert len(body.parts) == 2


@pytest.mark.parametrize("headers", [{}, {"content_length": "1"}])
async def test_a_body_that_does_not_say_so_is_counted(headers: dict[str, str]) -> None:
    with pytest.raises(BodyTooLargeError):
        await read_body(request_of(Body(), **headers), 4)


LIMITS = ServiceLimits(json_bytes=100, model_bytes=200, waypoints_bytes=300)


@pytest.mark.parametrize(
    ("path", "limit"),
    [
        ("/signals", 100),
        ("/systems/actuation/mode", 100),
        ("/model/check", 200),
        ("/inference", 200),
        ("/simulations", 200),
        ("/tasks", 300),
        ("/tasks/preview", 300),
    ],
)
@pytest.mark.parametrize("is_announced", [True, False])
async def test_every_route_keeps_the_limit_that_is_set_for_it(
    path: str, limit: int, is_announced: bool
) -> None:
    async def chunks(length: int) -> AsyncIterator[bytes]:
        yield b" " * length

    async with http_robot(limits=LIMITS) as robot:
        answers = []
        for length in (limit, limit + 1):
            content = b" " * length if is_announced else chunks(length)
            answers.append(await robot.http.post(path, content=content))

    assert answers[0].status_code != 413
    assert (answers[1].status_code, answers[1].json()["code"]) == (413, "TOO_LARGE")
    assert answers[1].json()["detail"] == f"the body is larger than {limit} bytes"
    assert answers[1].headers["x-content-type-options"] == "nosniff"
