"""`/model` and its check."""

import httpx
import pytest

from domain.findings import Finding
from tests.support.http_robot import ACTUATION, HttpRobot, http_robot

ODD = Finding("warning", "ODD", "this is odd", "drive_base", line=3, column=5)


async def check(robot: HttpRobot, text: str) -> httpx.Response:
    return await robot.http.post("/model/check", content=text)


async def test_the_model_is_shown_as_it_was_read(robot: HttpRobot) -> None:
    model = await robot.get("/model")

    performance = model["systems"]["actuation"]["modes"]["PERFORMANCE"]
    assert performance["drive_base"] == {"state": "active", "mode": "FAST"}
    assert model["nodes"]["drive_base"]["modes"]["FAST"] == {"max_speed": 0.9, "controller": "MPC"}
    assert model["warnings"] == []


async def test_what_is_odd_about_the_model_is_shown_with_its_place() -> None:
    async with http_robot(warnings=[ODD]) as robot:
        assert (await robot.get("/model"))["warnings"] == [
            {
                "severity": "warning",
                "code": "ODD",
                "message": "this is odd",
                "line": 3,
                "column": 5,
                "part": "drive_base",
            }
        ]


@pytest.mark.parametrize("accepted", ["application/yaml", "text/html, application/yaml;q=0.9"])
async def test_who_wants_yaml_gets_the_file_itself(accepted: str, robot: HttpRobot) -> None:
    answer = await robot.http.get("/model", headers={"accept": accepted})

    assert answer.headers["content-type"].startswith("application/yaml")
    assert answer.text == ACTUATION


async def test_a_good_model_is_valid(robot: HttpRobot) -> None:
    answer = await check(robot, ACTUATION)

    assert (answer.status_code, answer.json()) == (200, {"valid": True, "findings": []})


async def test_a_bad_model_is_told_all_that_is_wrong_with_line_and_column(
    robot: HttpRobot,
) -> None:
    text = ACTUATION.replace("active.SLOW", "active.SLOOW").replace("active.WEAK", "active.WEEK")

    answer = await check(robot, text)

    assert answer.status_code == 200
    findings = answer.json()["findings"]
    assert answer.json()["valid"] is False
    assert [(item["severity"], item["code"], item["line"]) for item in findings] == [
        ("error", "UNKNOWN_MODE", 6)
    ] * 2
    assert all(item["column"] for item in findings)


async def test_what_is_no_yaml_is_no_model(robot: HttpRobot) -> None:
    answer = await check(robot, "{[")

    assert (answer.status_code, answer.json()["valid"]) == (200, False)


async def test_what_is_no_text_cannot_be_checked(robot: HttpRobot) -> None:
    answer = await robot.http.post("/model/check", content=b"\xff\xfe\xfd")

    assert (answer.status_code, answer.json()["code"]) == (400, "MALFORMED")


async def test_a_model_of_more_than_eight_megabytes_is_not_read(robot: HttpRobot) -> None:
    answer = await check(robot, "#" * (8 * 1024 * 1024 + 1))

    assert (answer.status_code, answer.json()["code"]) == (413, "TOO_LARGE")
