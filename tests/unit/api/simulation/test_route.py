"""`/simulations`: the same core, fed with a scenario, in virtual time."""

import asyncio
from typing import Any

import pytest

from api.simulation import route
from domain.simulation.node_settings import Fault
from service.worker import WorkerBusyError
from tests.support.going_client import EndlessWork, GoingClient
from tests.support.http_robot import HttpRobot, http_scope
from tests.support.manual_clock import settle
from tests.support.robot_with_devices import device_robot
from tests.support.scenarios import ALL_GOOD, NEVER_STALE, STRAIGHT

VISIBLE = (
    "/systems",
    "/nodes",
    "/nodes/drive_base/parameters",
    "/changes",
    "/signals",
    "/system_state",
    "/emergency_stop",
    "/mock",
    "/tasks",
    "/holds",
    "/vehicle",
    "/events",
)
STORY = [
    ALL_GOOD,
    {"t_s": 1, "task": {"waypoints": STRAIGHT}},
    {"t_s": 2, "change": {"part": "actuation", "mode": "MODERATE"}},
    {"t_s": 3, "reading": {"estop": True}},
    {"t_s": 4, "request": {"method": "PUT", "path": "/holds/operator", "body": {}}},
    {"t_s": 5, "node": "drive_base", "fault": "die"},
    {"t_s": 5, "node": "manipulator", "parameters": {"max_torque": 0.3}},
    {"t_s": 6, "request": {"method": "PUT", "path": "/emergency_stop", "body": {"engaged": True}}},
    {"t_s": 7, "vehicle": "silent"},
]


async def simulate(to: HttpRobot, **body: object) -> Any:  # noqa: ANN401
    answer = await to.http.post("/simulations", json={"until_s": 10, **body})
    assert answer.status_code == 200, answer.text
    return answer.json()


async def visible(robot: HttpRobot) -> dict[str, Any]:
    return {path: await robot.get(path) for path in VISIBLE}


async def test_a_scenario_happens_in_the_worker_and_is_told(robot: HttpRobot) -> None:
    told = await simulate(robot, robot=NEVER_STALE, steps=STORY)

    assert [sample["t_s"] for sample in told["samples"]] == list(range(11))
    states = [sample["system_state"]["state"] for sample in told["samples"]]
    assert states[:4] == ["IDLE", "RUNNING", "RUNNING", "ERROR"]
    assert told["refusals"] == []
    assert {"task.started", "task.pausing", "hold.set"} <= {e["kind"] for e in told["events"]}


async def test_two_runs_are_the_same_to_the_byte(robot: HttpRobot) -> None:
    body = {"until_s": 10, "robot": NEVER_STALE, "steps": STORY}

    one, other = [await robot.http.post("/simulations", json=body) for _ in range(2)]

    assert one.content == other.content
    assert one.headers["content-type"] == "application/json"


async def test_a_copy_of_the_live_robot_begins_as_that_is(robot: HttpRobot) -> None:
    await robot.bring_to("actuation", "PERFORMANCE")
    await robot.http.put("/holds/operator", json={"reason": "lunch"})
    live = await robot.get("/systems/actuation")

    told = await simulate(robot, **{"from": "live"})

    copy = told["samples"][0]["parts"]["actuation"]
    assert (copy["actual"]["mode"], copy["target"]) == ("PERFORMANCE", live["target"])
    assert copy["converged"] is True
    newest = (await robot.get("/events"))["items"][-1]["id"]
    assert all(event["id"] > newest for event in told["events"])


async def test_what_happens_to_a_copy_never_happens_to_the_live_robot(robot: HttpRobot) -> None:
    await robot.bring_to("actuation", "PERFORMANCE")
    await robot.http.post("/tasks", json={"waypoints": STRAIGHT})
    await robot.pass_time(1)
    before = await visible(robot)

    told = await simulate(robot, steps=STORY, **{"from": "live"})

    assert "ESTOP" in told["samples"][-1]["system_state"]["errors"]
    assert await visible(robot) == before

    await robot.pass_time(3)
    assert (await robot.get("/tasks/current"))["status"] == "RUNNING"
    assert (await robot.get("/systems/actuation"))["actual"]["mode"] == "PERFORMANCE"


async def test_a_copy_has_the_faults_of_the_live_nodes(robot: HttpRobot) -> None:
    robot.break_node("drive_base", Fault.REFUSE)
    change = {"part": "drive_base", "transition": "configure"}

    told = await simulate(robot, steps=[{"t_s": 0, "change": change}], **{"from": "live"})

    assert "change.failed" in {event["kind"] for event in told["events"]}


async def test_the_word_live_elsewhere_begins_nothing_live(robot: HttpRobot) -> None:
    await robot.bring_to("actuation", "PERFORMANCE")

    told = await simulate(robot, title="live")

    assert told["samples"][0]["parts"]["actuation"]["actual"]["state"] == "unconfigured"


async def test_what_cannot_be_is_refused_with_its_place(robot: HttpRobot) -> None:
    wrong: dict[str, dict[str, object]] = {
        "/until_s": {"until_s": 86_401},
        "/sample_period_s": {"sample_period_s": 0},
        "": {"sample_period_s": 0.0001},
        "/steps/0": {"steps": [{"t_s": 0, "what": 1}]},
        "/steps/0/why": {"steps": [{"t_s": 0, "task": None, "why": "x"}]},
        "/robot/wings": {"robot": {"wings": 2}},
        "/from": {"from": "dead"},
        "/wings": {"wings": 2},
    }

    for pointer, body in wrong.items():
        answer = await robot.http.post("/simulations", json={"until_s": 10, **body})
        assert answer.status_code == 422, body
        assert answer.json()["errors"][0]["pointer"] == pointer


async def test_a_wrong_model_is_refused_with_its_findings(robot: HttpRobot) -> None:
    wrong = "arm: {ros__parameters: {type: system, modes: {__DEFAULT__: {arm: active}}}}"

    answer = await robot.http.post("/simulations", json={"until_s": 1, "model": wrong})

    assert answer.status_code == 422
    assert answer.json()["findings"][0]["line"] == 1


async def test_what_is_no_json_is_malformed(robot: HttpRobot) -> None:
    for raw in ("", "{", "[" * 100_000):
        answer = await robot.http.post("/simulations", content=raw)
        assert (answer.status_code, answer.json()["code"]) == (400, "MALFORMED")


async def test_a_simulation_within_a_simulation_is_refused(robot: HttpRobot) -> None:
    asked = {"method": "POST", "path": "/simulations", "body": {"until_s": 1}}

    told = await simulate(robot, steps=[{"t_s": 1, "request": asked}])

    (refused,) = told["refusals"]
    assert (refused["step"], refused["problem"]["status"]) == (0, 409)


async def test_a_refused_step_is_told_with_the_document_of_the_interface(
    robot: HttpRobot,
) -> None:
    steps = [
        {"t_s": 1, "reading": {"estop": True}},
        {"t_s": 1, "change": {"part": "actuation", "mode": "PERFORMANCE"}},
    ]

    told = await simulate(robot, robot=NEVER_STALE, steps=steps)

    (refused,) = told["refusals"]
    assert (refused["step"], refused["t_s"], refused["problem"]["status"]) == (1, 1.0, 409)
    assert refused["problem"]["blockers"][0]["code"] == "ESTOP"


async def test_the_live_robot_is_not_copied_for_a_queue_that_is_full(
    robot: HttpRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    copies: list[object] = []

    def refuse() -> None:
        raise WorkerBusyError

    monkeypatch.setattr(route, "forked_call", copies.append)
    monkeypatch.setattr(robot.app.state.simulator, "require_room", refuse)

    answer = await robot.http.post("/simulations", json={"from": "live", "until_s": 1})

    assert answer.status_code == 429
    assert not copies


async def test_a_simulation_is_given_up_when_its_client_disconnects(
    robot: HttpRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    client, work = GoingClient(b'{"until_s": 1}'), EndlessWork()
    monkeypatch.setattr(robot.app.state.simulator, "call", work.do)
    scope = http_scope("POST", "/simulations")
    request = asyncio.create_task(robot.app(scope, client.receive, client.send))
    await settle()
    assert not request.done()

    client.gone.set()
    await settle()

    assert work.is_given_up
    assert request.done()


async def test_an_answer_about_thousands_of_faults_is_short(robot: HttpRobot) -> None:
    steps = [{"t_s": 1, f"unknown {number}": "x" * 100} for number in range(3_000)]

    answer = await robot.http.post("/simulations", json={"until_s": 1, "steps": steps})

    assert answer.status_code == 422
    assert len(answer.json()["errors"]) <= 20
    assert len(answer.content) < 10_000


async def test_a_robot_of_several_computers_is_not_copied_and_says_so() -> None:
    async with device_robot() as (robot, _):
        robot.app.state.simulated = None  # Its nodes are on other computers.
        answer = await robot.http.post("/simulations", json={"from": "live", "until_s": 1})

    (fault,) = answer.json()["errors"]
    assert (answer.status_code, fault["pointer"]) == (422, "/from")
    assert "has several computers" in fault["message"]
