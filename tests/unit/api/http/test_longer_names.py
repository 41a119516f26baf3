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


async def test_a_part_is_shown_also_where_its_name_is_the_path_of_something_else() -> None:
    model = "left/errors/JAM: {ros__parameters: {type: node}}\n" + ROBOT
    async with http_robot(model) as robot:
        assert (await robot.get("/nodes/left/errors/JAM"))["name"] == PartName("left/errors/JAM")
        refused = await robot.http.put("/nodes/left/errors/JAM")
        of_another = await robot.http.get("/nodes/left/errors/STUCK")

    assert (refused.status_code, refused.headers["allow"]) == (405, "GET, HEAD, POST")
    assert (of_another.status_code, of_another.headers["allow"]) == (405, "POST")


async def test_what_is_no_path_of_anything_is_an_unknown_part() -> None:
    async with http_robot(ROBOT) as robot:
        answers = [
            await robot.http.get(f"/nodes/{path}")
            for path in ("right", "left/arm", "left/errors/JAM/more", "errors/JAM")
        ]
        of_system = await robot.http.get("/systems/left/checkpoints/c")

    assert [answer.json()["code"] for answer in answers] == ["UNKNOWN_PART"] * 4
    assert of_system.json()["code"] == "UNKNOWN_PART"
