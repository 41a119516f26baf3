"""HEAD is answered as GET is, without the body."""

import asyncio
from typing import Any

import pytest

from tests.support.http_robot import HttpRobot, http_scope


@pytest.mark.parametrize(
    "path",
    [
        "/systems",
        "/system_state",
        "/nodes/drive_base/mode",
        "/nodes/nothing",
        "/nodes/drive_base/errors/JAM",
        "/changes?limit=many",
        "/livez",
        "/openapi.json",
        "/docs",
        "/docs/swagger-ui.css",
        "/",
        "/nowhere",
    ],
)
async def test_status_and_headers_are_those_of_get(path: str, robot: HttpRobot) -> None:
    read = await robot.http.get(path)
    headed = await robot.http.head(path)

    assert headed.status_code == read.status_code
    assert headed.headers == read.headers
    assert headed.content == b""
    assert read.content


async def test_what_cannot_be_read_has_no_head_either(robot: HttpRobot) -> None:
    answer = await robot.http.head("/model/check")

    assert (answer.status_code, answer.headers["allow"]) == (405, "POST")


async def test_who_can_read_is_told_so(robot: HttpRobot) -> None:
    answer = await robot.http.delete("/systems")

    assert answer.headers["allow"] == "GET, HEAD"
    assert answer.json()["detail"] == "DELETE not allowed; allowed: GET, HEAD"


async def test_the_end_of_an_answer_without_its_body_is_sent_once(robot: HttpRobot) -> None:
    sent: list[dict[str, Any]] = []

    async def receive() -> dict[str, Any]:
        await asyncio.Event().wait()
        raise AssertionError

    async def send(message: Any) -> None:  # noqa: ANN401
        sent.append(message)

    await robot.app(http_scope("HEAD", "/docs/swagger-ui.css"), receive, send)

    assert [message["type"] for message in sent].count("http.response.start") == 1
    bodies = [message for message in sent if message["type"] == "http.response.body"]
    assert [message["body"] for message in bodies] == [b""]
    assert not bodies[0].get("more_body", False)
