"""`/inference`: what would the robot be in, if ..."""

from typing import Any

import pytest

from tests.support.http_robot import ACTUATION, HttpRobot

SLOW_AND_WEAK = {
    "drive_base": {"state": "active", "parameters": {"max_speed": 0.2, "controller": "PID"}},
    "manipulator": {"state": "active", "parameters": {"max_torque": 0.15}},
}


async def infer(robot: HttpRobot, **body: object) -> dict[str, Any]:
    answer = await robot.http.post("/inference", json=body)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


@pytest.mark.parametrize("model", [None, ACTUATION])
async def test_the_answer_is_the_same_for_the_loaded_model_and_for_the_same_one_posted(
    model: str | None, robot: HttpRobot
) -> None:
    targets = {"actuation": "active.PERFORMANCE"}

    answer = await infer(robot, model=model, targets=targets, nodes=SLOW_AND_WEAK)

    assert answer["parts"]["actuation"] == {
        "state": "activating",
        "mode": "MODERATE",
        "inferred": True,
        "mode_inferred": True,
        "undecidable": False,
        "reason": None,
    }
    assert answer["deviations"] == [
        {
            "part": "actuation",
            "target": {"state": "active", "mode": "PERFORMANCE"},
            "actual": {"state": "activating", "mode": None},
        }
    ]


async def test_a_target_is_taken_as_a_label_or_as_an_object_or_as_none(robot: HttpRobot) -> None:
    answers = [
        await infer(robot, targets={"actuation": target}, nodes=SLOW_AND_WEAK)
        for target in ("active.MODERATE", {"state": "active", "mode": "MODERATE"}, None)
    ]

    assert [answer["parts"]["actuation"]["state"] for answer in answers] == ["active"] * 3
    assert [answer["parts"]["actuation"]["mode"] for answer in answers] == [
        "MODERATE",
        "MODERATE",
        None,
    ]


async def test_a_node_that_is_left_out_never_reported(robot: HttpRobot) -> None:
    answer = await infer(robot, nodes={"drive_base": {"state": "active"}, "manipulator": {}})

    assert answer["parts"]["manipulator"]["state"] == "unknown"
    assert answer["parts"]["actuation"]["undecidable"] is True
    assert "manipulator" in answer["parts"]["actuation"]["reason"]


async def test_a_reported_mode_outranks_the_parameters(robot: HttpRobot) -> None:
    node = {**SLOW_AND_WEAK["drive_base"], "mode": "FAST"}

    answer = await infer(robot, nodes={"drive_base": node})

    found = answer["parts"]["drive_base"]
    assert (found["mode"], found["mode_inferred"]) == ("FAST", False)


async def test_a_node_that_is_not_active_has_no_mode(robot: HttpRobot) -> None:
    node = {"state": "inactive", "mode": "FAST"}

    answer = await infer(robot, nodes={"drive_base": node})

    assert answer["parts"]["drive_base"]["mode"] is None


async def test_nothing_of_it_touches_the_robot(robot: HttpRobot) -> None:
    await infer(robot, targets={"actuation": "active.PERFORMANCE"}, nodes=SLOW_AND_WEAK)

    assert (await robot.get("/systems/actuation"))["target"] is None


@pytest.mark.parametrize(
    ("body", "pointers"),
    [
        ({"targets": {"x": None, "y": "active"}}, ["/targets/x", "/targets/y"]),
        ({"nodes": {"actuation": {"state": "active"}}}, ["/nodes/actuation"]),
        ({"targets": {"actuation": "aktiv"}}, ["/targets/actuation/state"]),
        ({"nodes": {"drive_base": {"state": "on"}}}, ["/nodes/drive_base/state"]),
        ({"nodes": {"drive_base": {"stat": "active"}}}, ["/nodes/drive_base/stat"]),
        (
            {"nodes": {"drive_base": {"parameters": {"a/b": [1, "x"]}}}},
            ["/nodes/drive_base/parameters/a~1b"],
        ),
        ({"node": {}}, ["/node"]),
        ([], [""]),
    ],
)
@pytest.mark.parametrize("model", [None, ACTUATION])
async def test_what_is_wrong_in_the_body_is_told_with_its_place(
    model: str | None, body: object, pointers: list[str], robot: HttpRobot
) -> None:
    if model is not None and isinstance(body, dict):
        body = {**body, "model": model}

    answer = await robot.http.post("/inference", json=body)

    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == pointers


async def test_an_invalid_model_is_refused_with_its_findings(robot: HttpRobot) -> None:
    model = ACTUATION.replace("active.SLOW", "active.SLOOW")

    answer = await robot.http.post("/inference", json={"model": model})

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_MODEL")
    (finding,) = answer.json()["findings"]
    assert (finding["code"], finding["line"]) == ("UNKNOWN_MODE", 6)


async def test_a_large_body_about_the_loaded_model_is_left_to_the_worker(robot: HttpRobot) -> None:
    padding = {f"p{number}": "x" * 100 for number in range(200)}
    nodes = {"drive_base": {"state": "inactive", "parameters": padding}}

    answer = await infer(robot, nodes=nodes)

    assert answer["parts"]["drive_base"]["state"] == "inactive"


async def test_what_is_no_json_is_malformed(robot: HttpRobot) -> None:
    answer = await robot.http.post("/inference", content="{")

    assert (answer.status_code, answer.json()["code"]) == (400, "MALFORMED")
