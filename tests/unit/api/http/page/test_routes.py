"""The files of the page, and nothing else."""

import json
import re
import threading
from pathlib import Path

import pytest

from api.http.access import Access
from api.http.page import routes
from api.http.page.assembled_page import assembled_page
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.websocket import WebSocketClient

BLOCK = re.compile(r'<script type="application/json" id="first-frame">(.*)</script>\n')


async def test_the_page_is_at_the_root(robot: HttpRobot) -> None:
    answer = await robot.http.get("/")

    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    assert "<!doctype html>" in answer.text.lower()


async def test_everything_that_the_page_names_is_there_compressed_and_may_be_kept(
    robot: HttpRobot,
) -> None:
    page = (await robot.http.get("/")).text
    named = re.findall(r'(?:href|src)="(/web/[^"]+)"', page)

    assert named
    for path in named:
        answer = await robot.http.get(path)
        assert answer.status_code == 200, path
        assert answer.headers["content-encoding"] == "gzip", path
        assert answer.headers["cache-control"] == "public, max-age=31536000, immutable", path


async def test_the_page_holds_what_the_stream_would_tell_first(robot: HttpRobot) -> None:
    await robot.pass_time(1)

    page = await robot.http.get("/")
    async with WebSocketClient(robot.app) as client:
        streamed = [await client.frame("hello"), await client.frame("state")]

    assert page.headers["cache-control"] == "no-store"
    (block,) = BLOCK.findall(page.text)
    told = json.loads(block)
    assert told == streamed
    assert told[1]["parts"].keys() == {"actuation", "drive_base", "manipulator"}


async def test_a_page_that_anybody_may_load_tells_nothing_if_a_token_is_needed() -> None:
    token = "a-token-that-is-long-enough"
    async with http_robot(access=Access.with_token(token)) as robot:
        await robot.pass_time(1)
        for headers in ({}, {"authorization": f"Bearer {token}"}):
            page = await robot.http.get("/", headers=headers)

            assert BLOCK.findall(page.text) == []
            assert "drive_base" not in page.text
            assert page.headers["cache-control"] == "no-cache"


async def test_a_page_knows_its_version_and_the_stream_tells_that_of_the_service(
    robot: HttpRobot,
) -> None:
    page = (await robot.http.get("/")).text
    async with WebSocketClient(robot.app) as client:
        hello = await client.frame("hello")

    assert f'<meta name="page-version" content="{hello["page_version"]}">' in page


async def test_a_file_is_read_beside_the_loop_when_it_is_asked_for(
    robot: HttpRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    readers = []

    class Slow:
        def read_bytes(self) -> bytes:
            readers.append(threading.current_thread())
            return b"// as it is written"

    monkeypatch.setattr(routes, "written_files", lambda: {"js/slow.js": Slow()})

    answer = await robot.http.get("/web/js/slow.js")

    assert (answer.status_code, answer.text) == (200, "// as it is written")
    (reader,) = readers
    assert reader is not threading.current_thread()


async def test_a_file_that_was_removed_since_the_start_is_not_there(
    robot: HttpRobot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(routes, "written_files", lambda: {"js/gone.js": tmp_path / "gone.js"})

    assert (await robot.http.get("/web/js/gone.js")).status_code == 404


async def test_files_of_another_version_are_not_there(robot: HttpRobot) -> None:
    version = assembled_page().version

    assert (await robot.http.get(f"/web/v/{version}/core-1.js")).status_code == 200
    assert (await robot.http.get("/web/v/0123456789ab/core-1.js")).status_code == 404


@pytest.mark.parametrize(
    ("path", "media_type"),
    [
        ("/web/index.html", "text/html; charset=utf-8"),
        ("/web/style/base.css", "text/css; charset=utf-8"),
        ("/web/js/main.js", "text/javascript; charset=utf-8"),
        ("/web/icon.svg", "image/svg+xml"),
    ],
)
async def test_the_files_can_be_read_as_they_are_written(
    path: str, media_type: str, robot: HttpRobot
) -> None:
    answer = await robot.http.get(path)

    assert answer.headers["content-type"] == media_type
    assert answer.headers["cache-control"] == "no-cache"


async def test_a_file_that_the_browser_has_is_not_sent_again(robot: HttpRobot) -> None:
    tag = (await robot.http.get("/web/index.html")).headers["etag"]

    again = await robot.http.get("/web/index.html", headers={"if-none-match": f'"other", {tag}'})
    assert (again.status_code, again.content) == (304, b"")
    other = await robot.http.get("/web/index.html", headers={"if-none-match": '"other"'})
    assert other.status_code == 200


@pytest.mark.parametrize(
    "path",
    [
        "/web/",
        "/web/__init__.py",
        "/web/py.typed",
        "/web/%2e%2e/api/app.py",
        "/web/..%2fpyproject.toml",
        "/web//etc/passwd",
        "/web/js",
        "/web/v",
        "/web/v/",
        f"/web/v/{assembled_page().version}/",
        f"/web/v/{assembled_page().version}/..%2findex.html",
        f"/web/v/{assembled_page().version}/index.html",
        "/index.html",
    ],
)
async def test_nothing_else_can_be_asked_for(path: str, robot: HttpRobot) -> None:
    assert (await robot.http.get(path)).status_code == 404
