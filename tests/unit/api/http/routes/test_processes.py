"""`/nodes/{node}/process`: a node's program runs, ends, and is started again."""

from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from domain.commands import StartProcess, StopProcess
from domain.process_terms import ProcessExit
from domain.processes.settings import ProcessSettings
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from domain.timebase import seconds
from service.ports import ProcessOutput
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.process_runner import ScriptedProcesses

BASE = PartName("drive_base")
PATH = "/nodes/drive_base/process"
SETTINGS = SupervisionSettings(
    processes={BASE: ProcessSettings(starts=2, first_back_off=seconds(1))}
)


@pytest.fixture
async def running() -> AsyncIterator[HttpRobot]:
    """Return a robot with a process that nobody runs yet."""
    async with http_robot(settings=SETTINGS) as robot:
        yield robot


async def ask(robot: HttpRobot, action: str, path: str = PATH) -> tuple[int, dict[str, object]]:
    answer = await robot.http.post(path, json={"action": action})
    return answer.status_code, answer.json()


async def test_a_process_is_shown_while_it_runs_and_after_it_ended(running: HttpRobot) -> None:
    runner = ScriptedProcesses(running.supervisor, BASE)
    runner.is_ready()
    runner.runs(4711)
    shown = await running.get(PATH)
    assert (shown["state"], shown["pid"], shown["starts_left"]) == ("running", 4711, 1)

    runner.printed = ProcessOutput((), ("ready", "oops"))
    runner.ends(ProcessExit(1))
    shown = await running.get(PATH)

    assert (shown["state"], shown["pid"]) == ("waiting", None)
    assert (shown["exit"]["reason"], shown["exit"]["output"]) == ("exit code 1", ["ready", "oops"])
    (error,) = (await running.get("/nodes/drive_base/errors?active=true"))["items"]
    assert (error["error"], error["severity"]) == ("PROCESS_ENDED", "urgent")

    await running.pass_time(1)
    assert runner.told == [StartProcess(BASE), StartProcess(BASE)]


async def test_an_operator_restarts_and_stops_it(running: HttpRobot) -> None:
    runner = ScriptedProcesses(running.supervisor, BASE)
    runner.is_ready()
    runner.runs(4711)

    status, shown = await ask(running, "restart")
    assert (status, shown["state"]) == (200, "stopping")
    runner.ends(ProcessExit(signal="SIGINT"))
    runner.runs(4712)
    await ask(running, "stop")
    runner.ends(ProcessExit(signal="SIGINT"))

    assert (await running.get(PATH))["state"] == "stopped"
    sent = [StartProcess(BASE), StopProcess(BASE), StartProcess(BASE), StopProcess(BASE)]
    assert runner.told == sent
    asked = (await running.get("/events?kind=process.requested"))["items"]
    assert [event["data"]["action"] for event in asked] == ["restart", "stop"]


async def test_where_the_nodes_are_simulated_nothing_is_run(running: HttpRobot) -> None:
    status, problem = await ask(running, "start")

    assert (status, problem["code"]) == (409, "PROCESS_NOT_RUN_HERE")
    assert (await running.get(PATH))["state"] == "not_run_here"


@pytest.mark.parametrize(
    ("path", "code"),
    [
        ("/nodes/manipulator/process", "UNKNOWN_PROCESS"),
        ("/nodes/gripper/process", "UNKNOWN_PART"),
        ("/nodes/actuation/process", "UNKNOWN_PART"),
    ],
)
async def test_a_node_without_a_process_is_told(path: str, code: str, running: HttpRobot) -> None:
    for answer in (
        await running.http.get(path),
        await running.http.post(path, json={"action": "stop"}),
    ):
        assert (answer.status_code, answer.json()["code"]) == (404, code)


async def test_another_word_is_refused(running: HttpRobot) -> None:
    status, problem = await ask(running, "kill")

    assert (status, problem["code"]) == (422, "INVALID_BODY")


async def test_a_simulation_starts_no_program(running: HttpRobot, tmp_path: Path) -> None:
    touched = tmp_path / "touched"
    process = {"command": ["touch", str(touched)], "restart": "always"}
    body = {
        "until_s": 5,
        "robot": {"backend": "ros2", "nodes": {"drive_base": {"process": process}}},
        "steps": [
            {"t_s": 1, "request": {"method": "GET", "path": PATH}, "refused": True},
            {
                "t_s": 1,
                "request": {"method": "POST", "path": PATH, "body": {"action": "start"}},
                "refused": True,
            },
        ],
    }
    answer = await running.http.post("/simulations", json=body)

    assert answer.status_code == 200, answer.text
    assert [each["problem"]["code"] for each in answer.json()["refusals"]] == [
        "UNKNOWN_PROCESS",
        "UNKNOWN_PROCESS",
    ]
    assert not touched.exists()
