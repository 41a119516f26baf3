"""`/systems` and `/nodes` as an operator uses them."""

import asyncio
from typing import NamedTuple

import pytest

from domain.inputs import BackendStatus
from domain.simulation.node_settings import Fault, NodeSettings
from domain.timebase import seconds
from tests.support.going_client import GoingClient
from tests.support.http_robot import ACTUATION, HttpRobot, http_robot, http_scope
from tests.support.manual_clock import settle
from tests.support.tables import table

PART_FIELDS = {
    "name",
    "kind",
    "parts",
    "target",
    "effective_target",
    "actual",
    "converged",
    "deviation_since_at",
    "deviation_reason",
    "reachable",
    "change",
    "device",
    "last_known",
}

NESTED = """\
left/arm:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {max_torque: 0.1}}
left/arm/wrist:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {max_torque: 0.1}}
left/side:
  ros__parameters:
    type: system
    modes:
      __DEFAULT__: {left/arm: active, left/arm/wrist: active}
"""


# --- reading -----------------------------------------------------------------------------------


async def test_systems_and_nodes_are_listed_apart_in_the_order_of_the_file(
    robot: HttpRobot,
) -> None:
    systems, nodes = await robot.get("/systems"), await robot.get("/nodes")

    assert [item["name"] for item in systems["items"]] == ["actuation"]
    assert [item["name"] for item in nodes["items"]] == ["drive_base", "manipulator"]


async def test_a_part_is_shown_with_every_field_whether_it_has_a_value_or_not(
    robot: HttpRobot,
) -> None:
    part = await robot.get("/nodes/drive_base")

    assert set(part) == PART_FIELDS
    assert (part["kind"], part["parts"], part["target"]) == ("node", [], None)
    assert part["actual"] == {
        "state": "unconfigured",
        "mode": None,
        "inferred": False,
        "mode_inferred": False,
        "undecidable": False,
        "reason": None,
    }


async def test_a_system_names_its_parts_and_its_state_is_marked_as_inferred(
    robot: HttpRobot,
) -> None:
    part = await robot.get("/systems/actuation")

    assert set(part["parts"]) == {"drive_base", "manipulator"}
    assert part["actual"]["inferred"] is True


async def test_after_a_change_target_and_actual_tell_state_and_mode_and_why(
    robot: HttpRobot,
) -> None:
    await robot.bring_to("actuation", "PERFORMANCE")

    part = await robot.get("/systems/actuation")

    assert part["target"] == {"state": "active", "mode": "PERFORMANCE"}
    assert part["effective_target"] == {
        "state": "active",
        "mode": "PERFORMANCE",
        "because": "requested",
        "rule": None,
        "reaction": None,
        "cause": None,
        "blockers": [],
    }
    assert (part["actual"]["state"], part["actual"]["mode"]) == ("active", "PERFORMANCE")
    assert part["converged"] is True


async def test_the_state_comes_with_the_transitions_that_would_be_accepted(
    robot: HttpRobot,
) -> None:
    assert await robot.get("/nodes/drive_base/state") == {
        "state": "unconfigured",
        "inferred": False,
        "target": None,
        "available_transitions": ["configure", "activate", "shutdown"],
    }


async def test_the_target_of_state_and_mode_is_a_label(robot: HttpRobot) -> None:
    await robot.bring_to("actuation", "MODERATE")

    assert (await robot.get("/systems/actuation/state"))["target"] == "active.MODERATE"
    assert await robot.get("/systems/actuation/mode") == {
        "mode": "MODERATE",
        "inferred": True,
        "target": "active.MODERATE",
    }


async def test_a_part_that_is_not_active_has_no_mode(robot: HttpRobot) -> None:
    mode = await robot.get("/nodes/drive_base/mode")

    assert mode == {"mode": None, "inferred": False, "target": None}


@pytest.mark.parametrize("path", ["/nodes/drive_base", "/systems/actuation"])
async def test_the_states_of_a_part_are_those_that_it_can_rest_in(
    path: str, robot: HttpRobot
) -> None:
    states = await robot.get(f"{path}/states")

    assert states == {"items": ["unconfigured", "inactive", "active", "finalized"]}


async def test_every_mode_tells_whether_it_can_be_entered(robot: HttpRobot) -> None:
    modes = await robot.get("/systems/actuation/modes")

    assert [item["mode"] for item in modes["items"]] == ["__DEFAULT__", "MODERATE", "PERFORMANCE"]
    assert all(item["can_enter"] and item["blockers"] == [] for item in modes["items"])


async def test_a_mode_with_a_node_that_is_gone_names_the_node_and_can_be_asked_for(
    robot: HttpRobot,
) -> None:
    robot.break_node("manipulator", Fault.DIE)
    await robot.pass_time(2)

    modes = (await robot.get("/systems/actuation/modes"))["items"]

    shown = next(item for item in modes if item["mode"] == "PERFORMANCE")
    (blocker,) = shown["blockers"]
    assert (shown["can_enter"], blocker["refuses"]) == (True, False)
    assert set(blocker) == {
        "code",
        "message",
        "path",
        "value",
        "threshold",
        "since_at",
        "root_cause",
        "refuses",
        "causes",
        "condition",
    }
    assert blocker["code"].startswith("UNREACHABLE")
    assert blocker["path"] == ["actuation", "manipulator"]
    answer = await robot.http.post("/systems/actuation/mode", json={"mode": "PERFORMANCE"})
    assert answer.status_code == 202


# --- names --------------------------------------------------------------------------------------


async def test_a_name_may_hold_slashes_and_the_longest_known_part_wins() -> None:
    async with http_robot(NESTED) as robot:
        assert (await robot.get("/nodes/left/arm"))["name"] == "left/arm"
        assert (await robot.get("/nodes/left/arm/wrist"))["name"] == "left/arm/wrist"
        assert (await robot.get("/nodes/left/arm/wrist/mode"))["mode"] is None
        assert (await robot.get("/systems/left%2Fside"))["name"] == "left/side"


@pytest.mark.parametrize(
    ("path", "hint"),
    [
        ("/nodes/actuation/mode", "/systems/actuation/mode"),
        ("/systems/drive_base", "/nodes/drive_base"),
        ("/systems/nobody", "known: actuation"),
        ("/nodes/drive_base/colour", "there is drive_base"),
    ],
)
async def test_who_asks_for_a_part_that_is_not_there_is_told_where_to_look(
    path: str, hint: str, robot: HttpRobot
) -> None:
    answer = await robot.http.get(path)

    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_PART")
    assert hint in answer.json()["hint"]


# --- changes ------------------------------------------------------------------------------------


async def test_a_mode_that_is_asked_for_is_begun_at_once_and_its_change_can_be_followed(
    robot: HttpRobot,
) -> None:
    answer = await robot.http.post("/systems/actuation/mode", json={"mode": "PERFORMANCE"})

    change = answer.json()
    assert answer.status_code == 202
    assert answer.headers["location"] == f"/changes/{change['id']}"
    assert (change["part"], change["status"]) == ("actuation", "running")
    assert change["request"] == {"mode": "PERFORMANCE"}
    await robot.pass_time(3)
    assert (await robot.get(answer.headers["location"]))["status"] == "succeeded"


async def test_a_body_is_read_as_json_whatever_curl_calls_it(robot: HttpRobot) -> None:
    answer = await robot.http.post(
        "/nodes/drive_base/mode",
        content='{"mode":"FAST"}',
        headers={"content-type": "application/x-www-form-urlencoded"},
    )

    assert answer.status_code == 202


class Waited(NamedTuple):
    wait_s: float
    status: int
    told: str
    fault: Fault | None = None


@table(
    {
        "until it succeeds": Waited(wait_s=5, status=200, told="succeeded"),
        "until it fails": Waited(wait_s=5, fault=Fault.REFUSE, status=409, told="failed"),
        "not long enough": Waited(wait_s=0.1, status=202, told="running"),
        "not at all": Waited(wait_s=0, status=202, told="running"),
    }
)
async def test_who_waits_is_told_how_it_ended(row: Waited, robot: HttpRobot) -> None:
    if row.fault is not None:
        robot.break_node("drive_base", row.fault)
    asked = robot.http.post(f"/nodes/drive_base/mode?wait={row.wait_s}", json={"mode": "FAST"})

    answer = await robot.while_time_passes(row.wait_s, asked)

    assert answer.json()["status"] == row.told
    assert answer.status_code == row.status


async def test_who_waits_for_a_node_that_does_not_come_to_an_end_hears_that_nobody_knows() -> None:
    async with http_robot(nodes={"drive_base": NodeSettings(configure=seconds(30))}) as robot:
        asked = robot.http.post("/nodes/drive_base/mode?wait=20", json={"mode": "FAST"})

        answer = await robot.while_time_passes(20, asked)

        assert (answer.status_code, answer.json()["status"]) == (504, "timed_out")


async def test_who_waits_for_a_change_that_somebody_else_replaces_is_told_so(
    robot: HttpRobot,
) -> None:
    asked = robot.http.post("/nodes/drive_base/mode?wait=5", json={"mode": "FAST"})
    waiting = asyncio.create_task(asked)
    await settle()
    await robot.http.post("/nodes/drive_base/mode", json={"mode": "SLOW"})

    answer = await waiting

    assert (answer.status_code, answer.json()["status"]) == (409, "superseded")


@pytest.mark.parametrize("wait", ["61", "-1", "nan", "inf", "soon"])
async def test_nobody_waits_for_longer_than_a_minute(wait: str, robot: HttpRobot) -> None:
    path = f"/systems/actuation/mode?wait={wait}"

    answer = await robot.http.post(path, json={"mode": "PERFORMANCE"})

    assert answer.status_code == 422
    assert (await robot.get("/changes"))["items"] == []


async def test_what_is_met_already_succeeds_without_a_step(robot: HttpRobot) -> None:
    await robot.bring_to("actuation", "MODERATE")

    answer = await robot.http.post("/systems/actuation/mode?wait=1", json={"mode": "MODERATE"})

    assert (answer.status_code, answer.json()["steps"]) == (200, [])


async def test_a_dry_run_tells_the_steps_and_changes_nothing(robot: HttpRobot) -> None:
    path = "/systems/actuation/mode?dry_run=true"

    answer = await robot.http.post(path, json={"mode": "PERFORMANCE"})

    plan = answer.json()
    assert answer.status_code == 200
    assert set(plan) == {"part", "request", "steps", "stages", "expected_s"}
    assert (plan["stages"], plan["expected_s"]) == (1, None)
    assert {(step["node"], step["action"]) for step in plan["steps"]} == {
        (node, action)
        for node in ("drive_base", "manipulator")
        for action in ("configure", "set_parameters", "activate")
    }
    assert (await robot.get("/changes"))["items"] == []
    assert (await robot.get("/systems/actuation"))["target"] is None


async def test_a_transition_takes_what_lies_between_on_the_way(robot: HttpRobot) -> None:
    path = "/nodes/drive_base/state?wait=5"

    answer = await robot.while_time_passes(
        5, robot.http.post(path, json={"transition": "activate"})
    )

    actions = [step["action"] for step in answer.json()["steps"]]
    assert (actions[0], actions[-1]) == ("configure", "activate")
    assert (await robot.get("/nodes/drive_base"))["actual"]["state"] == "active"


async def test_a_transition_that_does_not_lead_from_here_is_refused_with_those_that_do(
    robot: HttpRobot,
) -> None:
    answer = await robot.http.post("/nodes/drive_base/state", json={"transition": "deactivate"})

    problem = answer.json()
    assert (answer.status_code, problem["code"]) == (409, "ILLEGAL_TRANSITION")
    assert problem["available"] == ["configure", "activate", "shutdown"]


async def test_what_is_due_has_passed_for_whoever_asks_what_can_be_entered(
    robot: HttpRobot,
) -> None:
    """A loop that is a little late has not noticed yet that ESTOP may end."""
    for value in (True, False):
        await robot.http.post("/signals/estop", json={"value": value})
    await robot.pass_time(0.19)
    robot.clock.stall(0.02)

    modes = (await robot.get("/nodes/drive_base/modes"))["items"]
    state = await robot.get("/nodes/drive_base/state")
    answer = await robot.http.post("/nodes/drive_base/mode", json={"mode": "FAST"})

    assert {item["can_enter"] for item in modes} == {True}
    assert "activate" in state["available_transitions"]
    assert answer.status_code == 202


async def test_a_mode_with_a_long_name_can_be_entered_like_any_other() -> None:
    name = "VERY_" * 100 + "FAST"
    async with http_robot(ACTUATION.replace("FAST", name)) as robot:
        modes = (await robot.get("/nodes/drive_base/modes"))["items"]
        answer = await robot.http.post("/nodes/drive_base/mode", json={"mode": name})
    assert {item["mode"]: item["can_enter"] for item in modes}[name]
    assert answer.status_code == 202


async def test_under_estop_a_refusal_carries_the_blockers_that_the_modes_show(
    robot: HttpRobot,
) -> None:
    await robot.http.put("/emergency_stop", json={"engaged": True, "reason": "test"})

    answer = await robot.http.post("/systems/actuation/mode", json={"mode": "PERFORMANCE"})

    modes = (await robot.get("/systems/actuation/modes"))["items"]
    shown = next(item for item in modes if item["mode"] == "PERFORMANCE")
    assert (answer.status_code, answer.json()["code"]) == (409, "BLOCKED")
    assert answer.json()["blockers"] == shown["blockers"] != []
    assert shown["can_enter"] is False


@pytest.mark.parametrize("part", ["systems/actuation", "nodes/drive_base"])
async def test_what_is_answered_with_503_cannot_be_entered_and_says_so(
    robot: HttpRobot, part: str
) -> None:
    robot.supervisor.deliver(BackendStatus(available=False, reason="no network"))

    modes = (await robot.get(f"/{part}/modes"))["items"]
    for shown in modes:
        answer = await robot.http.post(f"/{part}/mode", json={"mode": shown["mode"]})
        assert (answer.status_code, answer.json()["code"]) == (503, "BACKEND_UNAVAILABLE")
        refusing = [each for each in shown["blockers"] if each["refuses"]]
        assert shown["can_enter"] is False
        assert [each["code"] for each in refusing] == ["BACKEND_UNAVAILABLE"]
        assert refusing[0]["message"] == answer.json()["detail"]
    answer = await robot.http.post(f"/{part}/state", json={"transition": "configure"})
    assert answer.status_code == 503
    assert (await robot.get(f"/{part}/state"))["available_transitions"] == []


@pytest.mark.parametrize(
    ("path", "body", "pointer"),
    [
        ("/systems/actuation/mode", {"mode": "LUDICROUS"}, "/mode"),
        ("/systems/actuation/mode", {"mode": 1}, "/mode"),
        ("/systems/actuation/mode", {"mode": ""}, "/mode"),
        ("/systems/actuation/mode", {"mode": "MODERATE", "now": True}, "/now"),
        ("/systems/actuation/mode", {}, "/mode"),
        ("/systems/actuation/mode", ["MODERATE"], ""),
        ("/systems/actuation/state", {"transition": "explode"}, "/transition"),
        ("/systems/actuation/state", {"transition": None}, "/transition"),
    ],
)
async def test_a_body_that_says_something_impossible_is_told_where(
    path: str, body: object, pointer: str, robot: HttpRobot
) -> None:
    answer = await robot.http.post(path, json=body)

    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [pointer]
    assert (await robot.get("/changes"))["items"] == []


async def test_a_client_that_goes_while_it_waits_leaves_nothing_behind(robot: HttpRobot) -> None:
    client = GoingClient(b'{"mode":"FAST"}')
    path = "/nodes/drive_base/mode"
    before = waiting_tasks()
    scope = http_scope("POST", path, "wait=60")
    request = asyncio.create_task(robot.app(scope, client.receive, client.send))
    await settle()
    assert not request.done()

    client.gone.set()
    await settle()

    assert request.done()
    assert waiting_tasks() == before


def waiting_tasks() -> int:
    """Count the tasks that are not the robot's own, which come and go as its nodes do."""
    return sum(not task.get_name().startswith("rest of a pacer") for task in asyncio.all_tasks())


@pytest.mark.parametrize("name", ["drive_base", "/drive_base", "%2Fdrive_base"])
async def test_a_leading_slash_of_a_name_is_left_out(robot: HttpRobot, name: str) -> None:
    assert (await robot.get(f"/nodes/{name}"))["name"] == "drive_base"
    answer = await robot.http.post(f"/nodes/{name}/mode", json={"mode": "FAST"})
    assert answer.json()["part"] == "drive_base"
    assert (await robot.get(f"/changes?part={name}"))["items"][0]["part"] == "drive_base"


@pytest.mark.parametrize("name", ["actuation", "/actuation"])
async def test_a_system_is_not_said_to_be_missing(robot: HttpRobot, name: str) -> None:
    problem = (await robot.http.get(f"/nodes/{name}/mode")).json()

    assert problem["detail"] == "'actuation' is a system, not a node"
    assert problem["hint"] == "actuation is a system: see /systems/actuation/mode"
