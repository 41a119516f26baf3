"""What a path has no method for is told with the methods that it has."""

from typing import Any

import pytest
from fastapi import Request
from starlette.exceptions import HTTPException

from api.http.path_methods import allowed_methods, require_allowed
from tests.support.http_robot import HttpRobot, http_robot, http_scope

ROBOT = """\
base/errors/JAM: {ros__parameters: {type: node}}
base: {ros__parameters: {type: node}}
"""


def asked(robot: HttpRobot, path: str, method: str = "GET") -> Request:
    scope: dict[str, Any] = {**http_scope(method, path), "app": robot.app}
    return Request(scope)


@pytest.mark.parametrize(
    ("path", "methods"),
    [
        ("/systems", ["GET", "HEAD"]),
        ("/tasks/current", ["DELETE", "GET", "HEAD"]),
        ("/tasks/preview", ["POST"]),
        ("/tasks/t1", ["GET", "HEAD"]),
        ("/nodes/drive_base", ["GET", "HEAD"]),
        ("/nodes/left/arm", ["GET", "HEAD"]),
        ("/nodes/left/arm/mode", ["GET", "HEAD", "POST"]),
        ("/nodes/left/arm/errors/JAM", ["POST"]),
        ("/systems/actuation/errors/X/shelf", ["DELETE", "PUT"]),
        ("/nodes/drive_base/reactions/R/acknowledge", ["POST"]),
        ("/signals/battery_level/history", ["GET", "HEAD"]),
        ("/nowhere", []),
        ("/nodes", ["GET", "HEAD"]),
        ("/", ["GET", "HEAD"]),
        ("*", []),
        ("", []),
    ],
)
async def test_the_routes_count_that_say_most_about_a_path(
    path: str, methods: list[str], robot: HttpRobot
) -> None:
    assert allowed_methods(asked(robot, path)) == methods


async def test_a_part_can_be_read_whatever_else_its_name_may_be() -> None:
    async with http_robot(ROBOT) as robot:
        assert allowed_methods(asked(robot, "/nodes/base/errors/JAM")) == ["GET", "HEAD", "POST"]
        assert allowed_methods(asked(robot, "/nodes/base/errors/STUCK")) == ["POST"]
        assert allowed_methods(asked(robot, "/systems/base/errors/JAM")) == ["POST"]


async def test_a_method_that_the_path_has_is_required(robot: HttpRobot) -> None:
    require_allowed(asked(robot, "/nodes/drive_base"))
    require_allowed(asked(robot, "/nodes/drive_base/errors/JAM", "POST"))

    with pytest.raises(HTTPException) as refused:
        require_allowed(asked(robot, "/nodes/drive_base/errors/JAM"))
    assert refused.value.status_code == 405
