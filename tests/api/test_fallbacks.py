"""A mode that falls back and returns, over HTTP, as an operator watches it."""

from collections.abc import AsyncIterator

import pytest

from tests.support.good import GOOD
from tests.support.http_robot import ACTUATION, HttpRobot, http_robot
from tests.support.models import ACTUATION as NAME
from tests.support.models import BASE

SETTINGS = """\
    mode_settings:
      PERFORMANCE: {invariants: ["temperature < 50"], fallback: MODERATE}
      MODERATE: {requires: ["battery_level >= 0.9"], invariants: ["battery_level >= 0.2"]}
"""
PART = f"/systems/{NAME}"


@pytest.fixture
async def robot() -> AsyncIterator[HttpRobot]:
    """Return a robot in PERFORMANCE."""
    text = ACTUATION.replace("    type: system\n", f"    type: system\n{SETTINGS}")
    async with http_robot(text) as running:
        await running.http.post("/signals", json={**GOOD, "battery_level": 0.6})
        await running.bring_to(NAME, "PERFORMANCE")
        await running.http.post("/signals", json={**GOOD, "battery_level": 0.6})
        yield running


async def test_it_falls_back_says_why_and_returns(robot: HttpRobot) -> None:
    await robot.http.post("/signals/temperature", json={"value": 52.0})
    part = await robot.get(PART)
    pursued, why = part["effective_target"], (await robot.get(f"{PART}/why"))["blockers"]
    assert part["target"] == {"state": "active", "mode": "PERFORMANCE"}
    assert (pursued["mode"], pursued["because"], pursued["rule"]) == ("MODERATE", "invariant", None)
    assert pursued["blockers"][0]["condition"] == "temperature < 50"
    assert pursued["blockers"][0] in why
    assert (await robot.get(f"/nodes/{BASE}"))["effective_target"]["because"] == "invariant"
    (change, *_) = (await robot.get("/changes"))["items"]
    assert change["part"] == NAME

    await robot.http.post("/signals/temperature", json={"value": 40.0})
    await robot.pass_time(1.1)
    assert (await robot.get(PART))["effective_target"]["because"] == "requested"


async def test_without_a_fallback_the_error_of_the_part_is_listed(robot: HttpRobot) -> None:
    await robot.http.post("/signals/temperature", json={"value": 52.0})
    await robot.pass_time(1.0)
    await robot.http.post("/signals/battery_level", json={"value": 0.1})
    errors = (await robot.get(f"{PART}/errors"))["items"]
    broken = next(error for error in errors if error["error"] == "INVARIANT_BROKEN")
    assert (broken["state"], broken["severity"]) == ("active", "warning")
    assert broken["message"].startswith(f"{NAME} cannot stay MODERATE: battery_level is 0.1")
