"""`/errors`: what is wrong with the robot and with its parts, as an operator asks for it."""

from typing import Any

import pytest

from domain.simulation.node_settings import Fault
from tests.support.http_robot import HttpRobot, http_robot

ERROR_FIELDS = {
    "error",
    "part",
    "severity",
    "state",
    "shelved_until_at",
    "suppressed",
    "chattering",
    "root_cause",
    "first_out",
    "caused_by",
    "roots",
    "message",
    "value",
    "threshold",
    "since_at",
    "ended_at",
    "shelved_because",
    "count",
    "hint",
}
OF_NODES = [
    "UNREACHABLE",
    "ERROR_PROCESSING",
    "PARAMETERS_DRIFTED",
    "DEVIATES",
    "CHANGE_FAILED",
    "INVARIANT_BROKEN",
]

NAMED_ERRORS = """\
left:
  ros__parameters:
    type: node
left/errors:
  ros__parameters:
    type: node
right/errors:
  ros__parameters:
    type: node
both:
  ros__parameters:
    type: system
    modes:
      __DEFAULT__: {left: active, left/errors: active, right/errors: active}
"""


def names(answer: Any) -> list[tuple[str | None, str]]:  # noqa: ANN401
    return [(item["part"], item["error"]) for item in answer["items"]]


async def test_all_errors_are_listed_those_of_the_robot_first(robot: HttpRobot) -> None:
    listed = await robot.get("/errors")
    assert {frozenset(item) for item in listed["items"]} == {frozenset(ERROR_FIELDS)}
    assert (None, "BATTERY_LOW") in names(listed)
    of_parts = [(part, error) for part, error in names(listed) if part]
    assert of_parts == [
        ("actuation", "DEVIATES"),
        ("actuation", "CHANGE_FAILED"),
        ("actuation", "INVARIANT_BROKEN"),
        *(("drive_base", error) for error in OF_NODES),
        *(("manipulator", error) for error in OF_NODES),
    ]
    assert {item["state"] for item in listed["items"]} == {"normal"}


async def test_of_a_robot_that_is_well_no_error_is_active(robot: HttpRobot) -> None:
    assert await robot.get("/errors?active=true") == {"items": []}


async def test_a_node_that_died_is_found_in_the_list_with_what_follows_for_its_system(
    robot: HttpRobot,
) -> None:
    await robot.bring_to("actuation", "PERFORMANCE")
    robot.break_node("drive_base", Fault.DIE)
    await robot.pass_time(5)

    active = await robot.get("/errors?active=true")

    assert set(names(active)) == {
        ("drive_base", "UNREACHABLE"),
        ("drive_base", "DEVIATES"),
        ("actuation", "DEVIATES"),
    }
    lost = next(item for item in active["items"] if item["error"] == "UNREACHABLE")
    assert (lost["severity"], lost["state"], lost["count"]) == ("urgent", "active", 1)
    assert lost["first_out"] is True
    assert lost["since_at"].endswith("Z")
    assert lost["roots"] == [{"part": "drive_base", "error": "UNREACHABLE"}]
    state = await robot.get("/system_state")
    assert (state["state"], state["error_code"]) == ("IDLE", 0)


async def test_the_errors_of_one_part_are_at_the_part_and_in_the_list(robot: HttpRobot) -> None:
    robot.break_node("drive_base", Fault.DIE)
    await robot.pass_time(3)

    at_part = await robot.get("/nodes/drive_base/errors")

    assert [item["error"] for item in at_part["items"]] == OF_NODES
    assert at_part == await robot.get("/errors?part=drive_base")
    assert at_part == await robot.get("/errors?part=/drive_base")
    assert names(await robot.get("/nodes/drive_base/errors?active=true")) == [
        ("drive_base", "UNREACHABLE")
    ]
    others = await robot.get("/nodes/drive_base/errors?active=false")
    assert [item["error"] for item in others["items"]] == OF_NODES[1:]
    assert names(await robot.get("/systems/actuation/errors")) == [
        ("actuation", "DEVIATES"),
        ("actuation", "CHANGE_FAILED"),
        ("actuation", "INVARIANT_BROKEN"),
    ]


async def test_an_error_of_a_signal_is_pending_before_it_is_active(robot: HttpRobot) -> None:
    await robot.http.post("/signals/gps_accuracy", json={"value": 300.0})
    await robot.pass_time(1)
    listed = await robot.get("/errors")
    lost = next(item for item in listed["items"] if item["error"] == "GPS_LOST")
    assert (lost["state"], lost["part"], lost["severity"]) == ("pending", None, "critical")
    assert await robot.get("/errors?active=true") == {"items": []}


async def test_a_failed_change_says_why_until_one_succeeds(robot: HttpRobot) -> None:
    robot.break_node("drive_base", Fault.REFUSE)
    await robot.http.post("/nodes/drive_base/mode", json={"mode": "FAST"})
    await robot.pass_time(2)
    (failed,) = (
        item
        for item in (await robot.get("/nodes/drive_base/errors"))["items"]
        if item["error"] == "CHANGE_FAILED"
    )
    assert (failed["state"], failed["value"]) == ("active", "failed")
    assert failed["message"].startswith("change c1 failed: drive_base: configure")


@pytest.mark.parametrize(
    "path", ["/errors?part=gripper", "/nodes/gripper/errors", "/nodes/actuation/errors"]
)
async def test_an_unknown_part_is_not_found(robot: HttpRobot, path: str) -> None:
    answer = await robot.http.get(path)
    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_PART")


async def test_active_is_true_or_false(robot: HttpRobot) -> None:
    answer = await robot.http.get("/errors?active=perhaps")
    assert answer.status_code == 422


async def test_a_part_whose_name_ends_in_errors_is_shown_and_not_hidden() -> None:
    async with http_robot(NAMED_ERRORS) as robot:
        assert (await robot.get("/nodes/left/errors"))["name"] == "left/errors"
        assert (await robot.get("/nodes/right/errors"))["name"] == "right/errors"
        assert len((await robot.get("/nodes/left/errors/errors"))["items"]) == len(OF_NODES)
        assert len((await robot.get("/errors?part=left"))["items"]) == len(OF_NODES)


async def test_the_emergency_stop_is_in_the_list_while_it_is_engaged(robot: HttpRobot) -> None:
    await robot.http.put("/emergency_stop", json={"engaged": True, "reason": "test"})
    (estop,) = (await robot.get("/errors?active=true"))["items"]
    assert (estop["error"], estop["part"], estop["state"]) == ("ESTOP", None, "active")
    await robot.http.put("/emergency_stop", json={"engaged": False})
    await robot.pass_time(1)
    assert await robot.get("/errors?active=true") == {"items": []}
