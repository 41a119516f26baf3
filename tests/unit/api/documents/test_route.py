"""The documents as a browser gets them."""

import re

import httpx
import pytest

from api.documents.asyncapi import stream_document
from tests.support.http_robot import HttpRobot

ASSETS = {
    "/docs/swagger-ui-bundle.js": "text/javascript; charset=utf-8",
    "/docs/swagger-ui.css": "text/css; charset=utf-8",
}


async def test_the_stream_is_described(robot: HttpRobot) -> None:
    answer = await robot.http.get("/asyncapi.json")

    assert answer.headers["content-type"] == "application/json"
    assert answer.content == stream_document()


async def test_everything_that_the_page_names_is_there(robot: HttpRobot) -> None:
    page = (await robot.http.get("/docs")).text
    named = re.findall(r'(?:href|src)="(/[^"]*)"', page)

    assert set(ASSETS) < set(named)
    for path in named:
        assert (await robot.http.get(path)).status_code == 200, path


async def test_the_page_may_show_the_images_of_its_style_sheet_and_do_nothing_else_more(
    robot: HttpRobot,
) -> None:
    usual = (await robot.http.get("/system_state")).headers["content-security-policy"]
    here = (await robot.http.get("/docs")).headers["content-security-policy"]

    assert set(here.split("; ")) - set(usual.split("; ")) == {"img-src 'self' data:"}
    assert "script-src 'self';" in here


@pytest.mark.parametrize("path", ASSETS)
async def test_a_file_of_the_page_is_sent_once(path: str, robot: HttpRobot) -> None:
    first = await robot.http.get(path)
    again = await robot.http.get(path, headers={"if-none-match": first.headers["etag"]})

    assert first.headers["content-type"] == ASSETS[path]
    assert first.headers["cache-control"] == "no-cache"
    assert (again.status_code, again.content) == (304, b"")


async def test_a_file_of_an_earlier_version_is_sent_anew(robot: HttpRobot) -> None:
    answer = await robot.http.get("/docs/swagger-ui.css", headers={"if-none-match": '"0.1"'})

    assert answer.status_code == 200


@pytest.mark.parametrize("path", ["/docs/", "/docs/main.py", "/docs/%2e%2e/main.py", "/docs/x.js"])
async def test_nothing_else_is_there(path: str, robot: HttpRobot) -> None:
    answer = await robot.http.get(path)

    assert answer.status_code == httpx.codes.NOT_FOUND


@pytest.mark.parametrize("path", ["/openapi.json", "/asyncapi.json"])
async def test_a_document_is_encoded_once_and_sent_once(path: str, robot: HttpRobot) -> None:
    first = await robot.http.get(path)
    again = await robot.http.get(path, headers={"if-none-match": first.headers["etag"]})

    assert (again.status_code, again.content) == (304, b"")


async def test_the_description_is_the_same_bytes_for_all(
    robot: HttpRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = await robot.http.get("/openapi.json")
    monkeypatch.setattr(robot.app, "openapi", None)

    assert (await robot.http.get("/openapi.json")).content == first.content


async def test_the_description_of_the_stream_is_made_once(
    robot: HttpRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = await robot.http.get("/asyncapi.json")
    monkeypatch.setattr("api.documents.route.stream_document", None)

    assert (await robot.http.get("/asyncapi.json")).content == first.content
