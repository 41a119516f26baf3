"""A part may be called like the path of a resource of another one."""

from domain.state_and_mode import PartName
from tests.support.http_robot import http_robot

ROBOT = """\
left/reactions: {ros__parameters: {type: node}}
left: {ros__parameters: {type: node}}
"""


async def test_the_longest_name_wins() -> None:
    async with http_robot(ROBOT) as robot:
        assert (await robot.get("/nodes/left/reactions"))["name"] == PartName("left/reactions")
        assert await robot.get("/nodes/left/reactions/reactions") == {"items": []}
