"""Whatever goes wrong is answered as a problem, also what the framework refuses."""

import asyncio
import time

import pytest

from service.worker import QUEUE_LENGTH
from tests.support.http_robot import HttpRobot


@pytest.mark.parametrize("path", ["/nope", "/web/nope.js", "/web/../api/app.py", "/systems/"])
async def test_what_is_not_there_is_not_found(path: str, robot: HttpRobot) -> None:
    answer = await robot.http.get(path)

    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["status"] == 404


@pytest.mark.parametrize(
    ("method", "path", "allowed"),
    [
        ("DELETE", "/systems/actuation/mode", "GET, HEAD, POST"),
        ("POST", "/systems", "GET, HEAD"),
        ("GET", "/nodes/drive_base/parameters", None),
        ("PUT", "/nodes/drive_base/parameters", "GET, HEAD, PATCH"),
        ("DELETE", "/emergency_stop", "GET, HEAD, PUT"),
        ("GET", "/errors/ESTOP/acknowledge", "POST"),
        ("TRACE", "/system_state", "GET, HEAD"),
        ("POST", "/tasks/current", "DELETE, GET, HEAD"),
        ("DELETE", "/tasks/preview", "POST"),
        ("DELETE", "/nodes/drive_base", "GET, HEAD"),
        ("GET", "/nodes/drive_base/errors/JAM", "POST"),
        ("DELETE", "/nodes/drive_base/errors/JAM", "POST"),
        ("GET", "/systems/actuation/errors/X/shelf", "DELETE, PUT"),
        ("OPTIONS", "/nodes/drive_base/errors/X/acknowledge", "POST"),
        ("GET", "/nodes/drive_base/reactions/R", "PATCH"),
        ("PUT", "/nodes/drive_base/reactions/R/acknowledge", "POST"),
        ("GET", "/nodes/drive_base/checkpoints/c", "POST"),
    ],
)
async def test_what_is_not_done_here_is_told_with_all_that_is(
    method: str, path: str, allowed: str | None, robot: HttpRobot
) -> None:
    answer = await robot.http.request(method, path)

    assert answer.headers.get("allow") == allowed
    if allowed is not None:
        assert (answer.status_code, answer.json()["code"]) == (405, "METHOD_NOT_ALLOWED")
        assert answer.headers["content-type"] == "application/problem+json"


async def test_what_is_wrong_with_the_query_is_told_by_its_name(robot: HttpRobot) -> None:
    answer = await robot.http.get("/changes?limit=many")

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_QUERY")
    assert answer.json()["errors"][0]["message"].startswith("query limit: ")


async def test_what_is_not_read_to_its_end_ends_the_connection(robot: HttpRobot) -> None:
    answer = await robot.http.put("/emergency_stop", content=b" " * 300_000)

    assert answer.status_code == 413
    assert answer.headers["connection"] == "close"


async def test_too_much_work_at_once_is_put_off_with_a_time(robot: HttpRobot) -> None:
    worker = robot.app.state.worker
    jobs = [asyncio.create_task(worker.call(time.sleep, 0.05)) for _ in range(1 + QUEUE_LENGTH)]
    await asyncio.sleep(0)

    answer = await robot.http.post("/model/check", content="a: 1")

    assert (answer.status_code, answer.json()["code"]) == (429, "BUSY")
    assert int(answer.headers["retry-after"]) > 0
    await asyncio.gather(*jobs)
