"""The files of the page, and nothing else."""

import re

import pytest

from tests.support.http_robot import HttpRobot


async def test_the_page_is_at_the_root(robot: HttpRobot) -> None:
    answer = await robot.http.get("/")

    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    assert "<!doctype html>" in answer.text.lower()


async def test_everything_that_the_page_names_is_there(robot: HttpRobot) -> None:
    page = (await robot.http.get("/")).text
    named = re.findall(r'(?:href|src)="(/web/[^"]+)"', page)

    assert named
    for path in named:
        assert (await robot.http.get(path)).status_code == 200, path


@pytest.mark.parametrize(
    ("path", "media_type"),
    [
        ("/web/index.html", "text/html; charset=utf-8"),
        ("/web/style.css", "text/css; charset=utf-8"),
        ("/web/js/main.js", "text/javascript; charset=utf-8"),
        ("/web/icon.svg", "image/svg+xml"),
    ],
)
async def test_a_browser_is_told_what_a_file_is(
    path: str, media_type: str, robot: HttpRobot
) -> None:
    assert (await robot.http.get(path)).headers["content-type"] == media_type


async def test_a_file_that_the_browser_has_is_not_sent_again(robot: HttpRobot) -> None:
    first = await robot.http.get("/web/index.html")
    tag = first.headers["etag"]

    for known in (tag, f'"other", W/{tag}'):
        again = await robot.http.get("/web/index.html", headers={"if-none-match": known})
        assert (again.status_code, again.content) == (304, b"")

    assert first.headers["cache-control"] == "no-cache"
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
        "/index.html",
    ],
)
async def test_nothing_else_can_be_asked_for(path: str, robot: HttpRobot) -> None:
    assert (await robot.http.get(path)).status_code == 404
