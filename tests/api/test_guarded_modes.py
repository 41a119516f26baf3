"""Modes with guards and an order, over HTTP, as an operator meets them."""

from collections.abc import AsyncIterator

import pytest

from tests.support.good import GOOD
from tests.support.http_robot import ACTUATION, HttpRobot, http_robot
from tests.support.models import ACTUATION as NAME

SETTINGS = """\
    mode_settings:
      PERFORMANCE:
        requires: ["battery_level >= 0.3", "drive_base.state != finalized"]
        invariants: ["temperature < 50"]
        transition: {order: sequential, sequence: [drive_base, manipulator], deadline_s: 20}
"""
"""Of the system, beside its modes."""
MODE = f"/systems/{NAME}/mode"


@pytest.fixture
async def robot() -> AsyncIterator[HttpRobot]:
    text = ACTUATION.replace("    type: system\n", f"    type: system\n{SETTINGS}")
    async with http_robot(text) as running:
        await running.http.post("/signals", json=GOOD)
        yield running


async def test_the_guards_of_a_mode_are_listed_and_it_can_be_entered(robot: HttpRobot) -> None:
    modes = {mode["mode"]: mode for mode in (await robot.get(f"/systems/{NAME}/modes"))["items"]}
    assert modes["PERFORMANCE"]["can_enter"] is True
    assert modes["PERFORMANCE"]["can_stay"] is None
    assert modes["PERFORMANCE"]["requires"] == [
        "battery_level >= 0.3",
        "drive_base.state != finalized",
    ]
    assert modes["PERFORMANCE"]["invariants"] == ["temperature < 50"]
    assert modes["MODERATE"]["requires"] == []


async def test_a_refusal_carries_the_tree_that_the_modes_show(robot: HttpRobot) -> None:
    await robot.http.post("/signals/battery_level", json={"value": 0.21})
    answer = await robot.http.post(MODE, json={"mode": "PERFORMANCE"})
    modes = (await robot.get(f"/systems/{NAME}/modes"))["items"]
    shown = next(mode for mode in modes if mode["mode"] == "PERFORMANCE")
    assert answer.status_code == 409
    assert answer.json()["blockers"] == shown["blockers"]
    (blocker,) = [b for b in shown["blockers"] if b["refuses"]]
    assert (blocker["code"], blocker["condition"]) == ("CONDITION", "battery_level >= 0.3")
    assert (blocker["value"], blocker["threshold"], blocker["causes"]) == (0.21, 0.3, [])


async def test_a_dry_run_tells_the_order(robot: HttpRobot) -> None:
    answer = await robot.http.post(f"{MODE}?dry_run=true", json={"mode": "PERFORMANCE"})
    plan = answer.json()
    assert plan["stages"] == 2
    assert {(s["node"], s["stage"], tuple(s["after"])) for s in plan["steps"]} == {
        ("drive_base", 0, ()),
        ("manipulator", 1, ("drive_base",)),
    }


@pytest.mark.parametrize("where", ["body", "query"])
async def test_a_request_that_waits_is_taken_and_begins_when_it_may(
    robot: HttpRobot, where: str
) -> None:
    await robot.http.post("/signals/battery_level", json={"value": 0.2})
    body = {"mode": "PERFORMANCE", **({"wait_for_s": 1.5} if where == "body" else {})}
    query = "?wait_for_s=1.5" if where == "query" else ""
    answer = await robot.http.post(f"{MODE}{query}", json=body)
    change = answer.json()
    assert (answer.status_code, change["status"]) == (202, "waiting")
    assert change["reason"] == "battery_level is 0.2, needs >= 0.3"
    assert (await robot.get(f"/systems/{NAME}"))["target"] is None
    await robot.http.post("/signals/battery_level", json={"value": 0.9})
    change = await robot.get(f"/changes/{change['id']}")
    assert change["status"] == "running"
    assert change["deadline_at"] is not None


@pytest.mark.parametrize("wait_for_s", [-1, 3601, "soon"])
async def test_a_time_to_wait_out_of_bounds_is_refused(
    robot: HttpRobot, wait_for_s: float | str
) -> None:
    body = {"mode": "PERFORMANCE", "wait_for_s": wait_for_s}
    assert (await robot.http.post(MODE, json=body)).status_code == 422


async def test_why_tells_what_keeps_a_part_from_its_target(robot: HttpRobot) -> None:
    there = await robot.get(f"/systems/{NAME}/why")
    assert (there["converged"], there["blockers"]) == (True, [])
    await robot.http.post(MODE, json={"mode": "PERFORMANCE"})
    why = await robot.get(f"/systems/{NAME}/why")
    assert set(why) == {"actual", "target", "effective_target", "converged", "blockers"}
    assert why["effective_target"]["because"] == "requested"
    assert {(b["code"], b["path"][-1]) for b in why["blockers"]} == {
        ("DEVIATES", "drive_base"),
        ("DEVIATES", "manipulator"),
    }


async def test_a_part_below_is_asked_why_in_the_same_way(robot: HttpRobot) -> None:
    await robot.http.post(MODE, json={"mode": "PERFORMANCE"})
    why = await robot.get("/nodes/drive_base/why")
    assert why["blockers"][0]["path"] == ["drive_base"]
