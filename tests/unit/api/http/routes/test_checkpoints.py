"""`/nodes/{node}/checkpoints/{name}`: the program of a node reports where it is."""

from collections.abc import AsyncIterator

import pytest

from domain.health.checkpoints import CheckpointSettings
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from tests.support.http_robot import HttpRobot, http_robot

SETTINGS = SupervisionSettings(
    checkpoints={
        PartName("drive_base"): CheckpointSettings(order={"sense": ("act",), "act": ("sense",)})
    }
)


@pytest.fixture
async def working() -> AsyncIterator[HttpRobot]:
    """Return a robot whose drive base is active and has checkpoints."""
    async with http_robot(settings=SETTINGS) as robot:
        await robot.bring_to("drive_base", "SLOW")
        yield robot


async def reach(robot: HttpRobot, name: str, node: str = "drive_base") -> int:
    answer = await robot.http.post(f"/nodes/{node}/checkpoints/{name}")
    return answer.status_code


async def errors_of(robot: HttpRobot) -> dict[str, str]:
    answer = await robot.get("/nodes/drive_base/errors?active=true")
    return {item["error"]: item["message"] for item in answer["items"]}


async def test_a_checkpoint_is_taken_without_an_answer(working: HttpRobot) -> None:
    assert [await reach(working, name) for name in ("sense", "act", "sense")] == [204] * 3
    assert await errors_of(working) == {}


async def test_the_wrong_order_is_an_error_of_the_node_at_once(working: HttpRobot) -> None:
    await reach(working, "sense")
    await reach(working, "sense")

    assert await errors_of(working) == {
        "CHECKPOINT_WRONG_ORDER": "sense was reached after sense, and act should have been"
    }


async def test_an_unknown_checkpoint_is_told_with_those_that_there_are(working: HttpRobot) -> None:
    answer = await working.http.post("/nodes/drive_base/checkpoints/sence")

    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_CHECKPOINT")
    assert answer.json()["hint"] == "known: sense, act; did you mean sense?"


async def test_a_node_of_which_none_were_declared_has_none(working: HttpRobot) -> None:
    answer = await working.http.post("/nodes/manipulator/checkpoints/sense")

    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_CHECKPOINT")
    assert answer.json()["hint"] == "the robot file has no checkpoints of manipulator"


@pytest.mark.parametrize(
    ("part", "hint"),
    [
        ("actuation", "actuation is a system, and only nodes have checkpoints: see /systems/"),
        ("drive_bas", "known: drive_base"),
    ],
)
async def test_only_nodes_have_checkpoints(working: HttpRobot, part: str, hint: str) -> None:
    answer = await working.http.post(f"/nodes/{part}/checkpoints/sense")

    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_PART")
    assert answer.json()["hint"].startswith(hint)
