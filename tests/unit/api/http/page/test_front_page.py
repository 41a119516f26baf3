"""The page with the first frame of the robot in it."""

import asyncio
import gzip
import json
import re

from fastapi import Request, Response

from api.http.page.assembled_page import AssembledPage
from api.http.page.front_page import FrontPage
from tests.support.http_robot import http_scope

PAGE = AssembledPage("1", "<body>\n", "</body>\n", {}, ())
BLOCK = re.compile(r'<script type="application/json" id="first-frame">(.*)</script>\n')


class Robot:
    """Tells a frame as often as it is asked for."""

    def __init__(self, frames: str | None) -> None:
        self.frames = frames
        self.asked = 0

    async def first_frames(self) -> str | None:
        self.asked += 1
        await asyncio.sleep(0)
        return self.frames


class Asked:
    """The page of one robot."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._front = FrontPage(PAGE)

    async def answer(self, accepted: str = "") -> Response:
        request = Request(http_scope("GET", "/", **{"accept-encoding": accepted}))
        return await self._front.answer(request, self._robot.first_frames)


async def test_the_page_holds_the_frame_and_is_kept_by_nobody() -> None:
    front = Asked(Robot('[{"type":"hello"}]'))

    plain = await front.answer()
    packed = await front.answer("gzip")

    text = bytes(plain.body).decode()
    assert text == gzip.decompress(bytes(packed.body)).decode()
    assert text.startswith("<body>\n<script ")
    assert text.endswith("</script>\n</body>\n")
    assert packed.headers["content-encoding"] == "gzip"
    for each in (plain, packed):
        assert each.headers["cache-control"] == "no-store"
        assert each.headers["vary"] == "Accept-Encoding"
        assert "etag" not in each.headers


async def test_without_a_frame_a_browser_may_keep_the_page() -> None:
    front = Asked(Robot(None))

    bare = await front.answer("gzip")

    assert gzip.decompress(bytes(bare.body)) == b"<body>\n</body>\n"
    assert bare.headers["cache-control"] == "no-cache"
    assert bare.headers["etag"]


async def test_nothing_in_a_frame_can_end_the_block() -> None:
    told = [{"reason": "</script><!--<script>\u2028&amp;"}]
    front = Asked(Robot(json.dumps(told, ensure_ascii=False)))

    text = bytes((await front.answer()).body).decode()

    (block,) = BLOCK.findall(text)
    assert "<" not in block
    assert json.loads(block) == told


async def test_the_page_of_a_large_robot_is_compressed_rarely_however_often_it_is_asked_for() -> (
    None
):
    robot = Robot(json.dumps([{"parts": {f"part_{n}": n * n for n in range(100_000)}}]))
    front = Asked(robot)

    answers = await asyncio.gather(*(front.answer("gzip") for _ in range(20)))

    assert robot.asked == 1
    assert len({bytes(each.body) for each in answers}) == 1


async def test_other_tasks_run_while_a_large_page_is_compressed() -> None:
    front = Asked(Robot(json.dumps(["x" * 1_000_000])))
    asked = asyncio.create_task(front.answer("gzip"))
    turns = 0

    while not asked.done():
        await asyncio.sleep(0)
        turns += 1

    assert turns > 30
