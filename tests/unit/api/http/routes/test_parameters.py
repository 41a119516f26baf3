"""`/nodes/{node}/parameters` as an operator uses it."""

import json
from typing import Any

import pytest

from tests.support.http_robot import HttpRobot

PATH = "/nodes/drive_base/parameters"


async def parameters(robot: HttpRobot) -> dict[str, Any]:
    return {item["name"]: item for item in (await robot.get(PATH))["items"]}


async def test_parameters_tell_value_type_and_what_the_target_mode_wants(
    robot: HttpRobot,
) -> None:
    await robot.bring_to("drive_base", "FAST")

    assert await parameters(robot) == {
        "controller": {"name": "controller", "value": "MPC", "type": "string", "wanted": "MPC"},
        "max_speed": {"name": "max_speed", "value": 0.9, "type": "double", "wanted": 0.9},
    }


async def test_without_a_target_nothing_is_wanted(robot: HttpRobot) -> None:
    assert {item["wanted"] for item in (await parameters(robot)).values()} == {None}


async def test_the_mode_follows_the_parameters_that_are_set(robot: HttpRobot) -> None:
    await robot.bring_to("drive_base", "FAST")

    answer = await robot.http.patch(PATH, json={"max_speed": 0.2, "controller": "PID"})
    await robot.pass_time(1)

    assert answer.status_code == 202
    change = await robot.get(answer.headers["location"])
    assert change["request"] == {"parameters": {"max_speed": 0.2, "controller": "PID"}}
    assert change["steps"][0]["action"] == "set_parameters"
    assert (await robot.get("/nodes/drive_base/mode"))["mode"] == "SLOW"


async def test_one_is_taken_as_a_double_where_the_node_has_a_double(robot: HttpRobot) -> None:
    await robot.http.patch(PATH, content='{"max_speed": 1}')
    await robot.pass_time(1)

    assert (await parameters(robot))["max_speed"]["value"] == 1.0


@pytest.mark.parametrize(
    ("body", "pointer", "code"),
    [
        ('{"max_speed": "fast"}', "/max_speed", "INVALID_VALUE"),
        ('{"max_speed": true}', "/max_speed", "INVALID_VALUE"),
        ('{"max_speed": NaN}', "/max_speed", "INVALID_PARAMETER"),
        ('{"max_speed": -Infinity}', "/max_speed", "INVALID_PARAMETER"),
        ('{"max_speed": 1e999}', "/max_speed", "INVALID_PARAMETER"),
        ('{"max_speed": null}', "/max_speed", "INVALID_PARAMETER"),
        ('{"max_speed": {"x": 1}}', "/max_speed", "INVALID_PARAMETER"),
        ('{"max_speed": [1, "x"]}', "/max_speed", "INVALID_PARAMETER"),
        ('{"max_speed": 9223372036854775808}', "/max_speed", "INVALID_PARAMETER"),
        (json.dumps({"controller": "x" * 4_097}), "/controller", "INVALID_PARAMETER"),
        (json.dumps({"max_speed": [1.0] * 1_025}), "/max_speed", "INVALID_PARAMETER"),
        ('{"wings/left": 1.0}', "/wings~1left", "UNKNOWN_PARAMETER"),
        ("{}", "", "TOO_SHORT"),
        ("[]", "", "DICT_TYPE"),
    ],
)
async def test_what_no_parameter_can_be_is_refused_with_its_place_and_nothing_is_set(
    body: str, pointer: str, code: str, robot: HttpRobot
) -> None:
    before = await parameters(robot)

    answer = await robot.http.patch(PATH, content=body)

    assert answer.status_code == 422
    (fault,) = answer.json()["errors"]
    assert (fault["pointer"], fault["code"]) == (pointer, code)
    await robot.pass_time(1)
    assert await parameters(robot) == before


async def test_all_are_set_or_none(robot: HttpRobot) -> None:
    before = await parameters(robot)

    answer = await robot.http.patch(PATH, content=json.dumps({"max_speed": 0.5, "wings": 2}))

    await robot.pass_time(1)
    assert answer.status_code == 422
    assert await parameters(robot) == before


async def test_a_system_has_no_parameters(robot: HttpRobot) -> None:
    answer = await robot.http.get("/nodes/actuation/parameters")

    assert answer.status_code == 404


async def test_parameters_can_be_tried_out_too(robot: HttpRobot) -> None:
    answer = await robot.http.patch(f"{PATH}?dry_run=true", json={"max_speed": 0.5})

    assert answer.status_code == 200
    assert [step["action"] for step in answer.json()["steps"]] == ["set_parameters"]
