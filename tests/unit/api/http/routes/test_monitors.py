"""`/monitors`: what is computed from signals, as an operator sees it."""

from collections.abc import AsyncIterator

import pytest

from domain.supervision import SupervisionSettings
from service.files.robot_file import robot_settings_of
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.models import actuation_model

SIGNALS = {
    "scan": {"stale_after_s": 0},
    "scan_rate": {
        "of": "scan",
        "statistic": "rate",
        "window_s": 2,
        "below": 0.8,
        "error": "SCAN_SLOW",
        "part": "drive_base",
        "severity": "urgent",
    },
    "scan_mean": {
        "of": "scan",
        "statistic": "mean",
        "window_n": 2,
        "error": "SCAN_HIGH",
        "limits": {"drive_base.FAST": {"above": 60}, "default": {"above": 80}},
    },
}


@pytest.fixture
async def robot() -> AsyncIterator[HttpRobot]:
    settings = robot_settings_of({"signals": SIGNALS}, actuation_model()).to_signal_settings()
    async with http_robot(settings=SupervisionSettings(settings)) as robot:
        yield robot


async def scan(robot: HttpRobot, value: float) -> None:
    answer = await robot.http.post("/signals/scan", json={"value": value})
    assert answer.status_code == 200


async def test_monitors_are_listed_with_their_windows(robot: HttpRobot) -> None:
    await robot.pass_time(1)
    rate, mean = (await robot.get("/monitors"))["items"]
    assert rate == {
        "signal": "scan_rate",
        "of": "scan",
        "statistic": "rate",
        "window_s": 2.0,
        "window_n": None,
        "filled": 0.5,
        "value": None,
        "limits": {"below": 0.8},
        "limits_because": None,
    }
    assert (mean["window_s"], mean["window_n"], mean["limits_because"]) == (None, 2, "default")


async def test_a_monitor_is_a_signal_and_raises_an_error_of_its_part(robot: HttpRobot) -> None:
    await scan(robot, 1.0)
    for _ in range(2):
        await robot.pass_time(1)
        await scan(robot, 1.0)
    assert (await robot.get("/signals/scan_rate"))["value"] == 1.0
    await robot.pass_time(1)

    signal = await robot.get("/signals/scan_rate")
    assert (signal["error"], signal["source"]) == ("SCAN_SLOW", "monitor")
    (error,) = (await robot.get("/nodes/drive_base/errors?active=true"))["items"]
    assert (error["error"], error["part"], error["severity"]) == (
        "SCAN_SLOW",
        "drive_base",
        "urgent",
    )
    assert (await robot.get("/system_state"))["errors"] == []


async def test_limits_follow_the_mode(robot: HttpRobot) -> None:
    for _ in range(2):
        await scan(robot, 70.0)
    assert (await robot.get("/system_state"))["errors"] == []
    await robot.bring_to("actuation", "PERFORMANCE")

    assert (await robot.get("/system_state"))["errors"] == ["SCAN_HIGH"]
    mean = (await robot.get("/monitors"))["items"][1]
    assert (mean["limits"], mean["limits_because"]) == ({"above": 60.0}, "drive_base.FAST")


async def test_readings_of_a_monitor_are_refused(robot: HttpRobot) -> None:
    answer = await robot.http.post("/signals/scan_rate", json={"value": 5})
    assert answer.status_code == 422
    assert "scan_rate is computed from scan" in answer.json()["detail"]
