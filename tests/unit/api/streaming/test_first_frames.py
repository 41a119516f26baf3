"""What the page shows before it is connected."""

import json

from api.http.access import Access
from api.streaming.first_frames import first_frames
from api.streaming.stream_server import stream_server
from tests.support.http_robot import HttpRobot, http_robot


async def test_it_is_the_beginning_of_the_stream(robot: HttpRobot) -> None:
    await robot.pass_time(1)

    text = await first_frames(stream_server(robot.app))

    assert text is not None
    hello, state = json.loads(text)
    assert (hello["type"], hello["epoch"]) == ("hello", robot.supervisor.epoch)
    assert (state["type"], state["skipped"]) == ("state", 0)
    assert {"parts", "signals", "errors", "task", "vehicle", "holds"} <= state.keys()


async def test_changes_are_in_it_at_once(robot: HttpRobot) -> None:
    await robot.pass_time(1)
    await robot.bring_to("drive_base", "FAST")

    text = await first_frames(stream_server(robot.app))

    assert text is not None
    assert json.loads(text)[1]["parts"]["drive_base"]["actual"]["mode"] == "FAST"


async def test_before_the_first_frame_there_is_nothing_to_show() -> None:
    assert await first_frames(stream_server(HttpRobot().app)) is None


async def test_who_needs_a_token_is_told_nothing() -> None:
    async with http_robot(access=Access.with_token("a-token-that-is-long-enough")) as robot:
        await robot.pass_time(1)

        assert await first_frames(stream_server(robot.app)) is None
