"""A path that is too long is rejected before anything looks at it."""

import pytest

from api.http.gate.target import MAX_FIELDS, MAX_PATH_BYTES, MAX_TARGET_BYTES
from tests.support.http_robot import HttpRobot


async def test_a_long_path_is_rejected_with_a_short_answer(robot: HttpRobot) -> None:
    answer = await robot.http.get("/nodes/" + "a/" * 30_000)

    assert (answer.status_code, answer.json()["code"]) == (414, "URI_TOO_LONG")
    assert len(answer.content) < 500


async def test_a_long_query_counts_as_well(robot: HttpRobot) -> None:
    answer = await robot.http.get("/events", params={"kind": "a" * MAX_TARGET_BYTES})

    assert answer.status_code == 414


async def test_a_query_of_many_fields_is_rejected(robot: HttpRobot) -> None:
    few = await robot.http.get("/events?limit=1" + "&a" * (MAX_FIELDS - 1))
    many = await robot.http.get("/events?limit=1" + "&a" * MAX_FIELDS)

    assert (few.status_code == 414, many.status_code) == (False, 414)


async def test_the_path_counts_as_it_was_sent(robot: HttpRobot) -> None:
    answer = await robot.http.get("/nodes/" + "%41" * (MAX_PATH_BYTES // 3))

    assert answer.status_code == 414


@pytest.mark.parametrize("name", ["a/" * 2_000, "/" * 4_000, "state/" * 650, "x" * 4_000])
async def test_the_longest_paths_get_short_answers(name: str, robot: HttpRobot) -> None:
    answer = await robot.http.get(f"/nodes/{name}")

    assert answer.status_code == 404
    assert len(answer.json()["detail"]) < 300
