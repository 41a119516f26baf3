"""A node is killed during a mode change and comes back, over HTTP."""

import pytest

from domain.changes.settings import ChangeSettings
from domain.simulation.node_settings import Fault
from domain.supervision import SupervisionSettings
from tests.support.http_operator import HttpOperator
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.models import BASE
from tests.support.scenarios import ALL_GOOD, NEVER_STALE

RESTORED = SupervisionSettings(changes=ChangeSettings(restored_nodes=frozenset({BASE})))
LEFT = SupervisionSettings()


async def kill_during_a_mode_change(robot: HttpRobot) -> str:
    """Return the path of the change into PERFORMANCE, of which the base does not see the end."""
    operator = HttpOperator(robot)
    change = await operator.ask_mode("actuation", "PERFORMANCE")
    await operator.advance(0.4)
    robot.break_node("drive_base", Fault.DIE)
    await operator.advance(12)
    return change


async def start_anew(robot: HttpRobot) -> None:
    robot.backend.set_fault(BASE, None)
    await robot.pass_time(2)


async def test_the_change_times_out_naming_the_node_and_the_system_says_why_it_deviates() -> None:
    async with http_robot(settings=RESTORED) as robot:
        change = await robot.get(await kill_during_a_mode_change(robot))
        system = await robot.get("/systems/actuation")

    assert (change["status"], change["reason"]) == (
        "timed_out",
        "drive_base: activate: the node is unreachable",
    )
    assert (system["converged"], system["target"]["mode"]) == (False, "PERFORMANCE")
    assert system["actual"]["state"] == "unknown"
    assert system["actual"]["reason"] == "drive_base is unreachable"


async def test_when_it_is_back_it_is_brought_to_its_target_by_a_change_that_nobody_asked_for() -> (
    None
):
    async with http_robot(settings=RESTORED) as robot:
        await kill_during_a_mode_change(robot)
        await start_anew(robot)
        system = await robot.get("/systems/actuation")
        newest = (await robot.get("/changes"))["items"][0]
        events = (await robot.get("/events?limit=1000"))["items"]

    assert (system["converged"], system["actual"]["mode"]) == (True, "PERFORMANCE")
    assert (newest["part"], newest["status"]) == ("drive_base", "succeeded")
    by_id = {event["id"]: event for event in events}
    restoring = by_id[newest["cause"]]
    assert (restoring["kind"], restoring["actor"]) == ("node.restoring", "")
    assert restoring["data"] == {"node": "drive_base", "target": "active.FAST"}
    assert by_id[restoring["cause"]]["kind"] == "node.reported"


async def test_where_nothing_was_declared_it_is_left_as_it_is() -> None:
    async with http_robot(settings=LEFT) as robot:
        await kill_during_a_mode_change(robot)
        await start_anew(robot)
        node = await robot.get("/nodes/drive_base")
        changes = (await robot.get("/changes"))["items"]

    assert (node["actual"]["state"], node["converged"]) == ("unconfigured", False)
    assert len(changes) == 1


@pytest.mark.parametrize(
    ("on_return", "ends"), [("restore", "active.FAST"), ("leave", "unconfigured")]
)
async def test_a_simulation_declares_it_like_a_robot_file(
    robot: HttpRobot, on_return: str, ends: str
) -> None:
    steps = [
        ALL_GOOD,
        {"t_s": 0.5, "change": {"part": "drive_base", "mode": "FAST"}},
        {"t_s": 2, "node": "drive_base", "fault": "die"},
        {"t_s": 6, "node": "drive_base", "fault": "recover"},
        {"t_s": 8, "expect": {"parts": {"drive_base": {"actual": ends}}}},
    ]
    nodes = {"drive_base": {"on_return": on_return}}
    body = {"until_s": 8, "robot": {**NEVER_STALE, "nodes": nodes}, "steps": steps}
    answer = await robot.http.post("/simulations", json=body)

    assert answer.status_code == 200, answer.text
    (expectation,) = answer.json()["expectations"]
    assert expectation["differences"] == []


async def test_a_copy_of_the_live_robot_restores_its_node_and_the_live_one_stays_as_it_is() -> None:
    async with http_robot(settings=RESTORED) as robot:
        await kill_during_a_mode_change(robot)
        steps = [
            {"t_s": 1, "node": "drive_base", "fault": "recover"},
            {"t_s": 3, "expect": {"parts": {"drive_base": {"actual": "active.FAST"}}}},
        ]
        body = {"from": "live", "until_s": 3, "steps": steps}
        answer = await robot.http.post("/simulations", json=body)
        live = await robot.get("/nodes/drive_base")

    (expectation,) = answer.json()["expectations"]
    assert expectation["differences"] == []
    assert live["actual"]["state"] == "unknown"
