import asyncio
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import pytest
from starlette.responses import JSONResponse
from starlette.types import Receive, Scope, Send

from api.http.schemas.problem import Problem
from api.http.schemas.simulation import AskedRequest
from api.simulation.requests import Requests
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.simulation.virtual_time import VirtualService
from tests.support.scenarios import STRAIGHT, scenario, virtual_robot
from tests.support.tables import table

Ask = Callable[..., Problem | None]


@pytest.fixture
def robot() -> VirtualService:
    robot = virtual_robot(scenario())
    robot.advance_to(seconds(0.1))
    return robot


@pytest.fixture
def ask(robot: VirtualService) -> Iterator[Ask]:
    with asyncio.Runner() as runner:
        requests = Requests(robot.supervisor, runner)

        def ask(method: str, path: str, body: Any = None) -> Problem | None:  # noqa: ANN401
            asked = {"method": method, "path": path, "body": body}
            return requests.send(AskedRequest.model_validate(asked))

        yield ask


@pytest.mark.parametrize(
    "path", ["/systems", "/nodes/drive_base/mode", "/system_state", "/tasks", "/vehicle", "/livez"]
)
def test_what_can_be_read_is_answered(path: str, ask: Ask) -> None:
    assert ask("GET", path) is None


def test_a_request_acts_on_the_robot_of_the_scenario(robot: VirtualService, ask: Ask) -> None:
    assert ask("PUT", "/emergency_stop", {"engaged": True, "reason": "test"}) is None

    assert "ESTOP" in robot.supervisor.core.system_state().errors


def test_work_of_the_worker_is_done_at_once(ask: Ask) -> None:
    waypoints = [STRAIGHT[0], {**STRAIGHT[0], "x_m": 1.0}] + STRAIGHT[2:] * 30

    assert ask("POST", "/tasks/preview", {"waypoints": waypoints}) is None


def test_who_waits_for_a_change_is_answered_while_it_is_still_running(
    robot: VirtualService, ask: Ask
) -> None:
    assert ask("POST", "/nodes/drive_base/mode?wait=60", {"mode": "FAST"}) is None

    change = next(iter(robot.supervisor.core.changes()))
    assert change.status == "running"
    assert change.part == PartName("drive_base")


def test_a_misspelt_field_of_a_query_moves_nothing_here_either(
    robot: VirtualService, ask: Ask
) -> None:
    refused = ask("POST", "/nodes/drive_base/mode?dry-run=true", {"mode": "FAST"})

    assert refused is not None
    assert (refused.status, refused.code) == (422, "INVALID_QUERY")
    assert list(robot.supervisor.core.changes()) == []


class Refused(NamedTuple):
    method: str
    path: str
    status: int
    body: object = None


BATTERY = "/signals/battery_level"


@table(
    {
        "a path that is not there": Refused("GET", "/nowhere", 404),
        "a hold of Pilothouse": Refused("PUT", "/holds/error", 409, body={"reason": "mine"}),
        "a value out of range": Refused("POST", BATTERY, 422, body={"value": 7}),
        "a value that is no number": Refused("POST", BATTERY, 422, body={"value": float("nan")}),
        "a method that is not there": Refused("PATCH", "/vehicle", 405),
        "a path that is no path": Refused("GET", "/\n", 400),
        "the path of another host": Refused("GET", "//elsewhere/vehicle", 404),
    }
)
def test_a_refusal_is_the_document_of_the_interface(row: Refused, ask: Ask) -> None:
    problem = ask(row.method, row.path, row.body)

    assert problem is not None
    assert problem.status == row.status


def test_a_failure_that_is_no_problem_document_is_told_as_it_is(
    robot: VirtualService, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def fail(scope: Scope, receive: Receive, send: Send) -> None:
        await JSONResponse({"id": "c1", "status": "failed"}, 409)(scope, receive, send)

    monkeypatch.setattr("api.simulation.requests.create_robot_app", lambda *_, **__: fail)
    asked = AskedRequest(method="POST", path="/nodes/drive_base/mode?wait=1")

    with asyncio.Runner() as runner:
        problem = Requests(robot.supervisor, runner).send(asked)

    assert problem is not None
    assert (problem.status, problem.instance) == (409, "/nodes/drive_base/mode?wait=1")
    assert problem.detail == 'answered: {"id":"c1","status":"failed"}'


def test_a_simulation_begins_no_other_one(ask: Ask) -> None:
    problem = ask("POST", "/simulations", {"until_s": 1})

    assert problem is not None
    assert problem.status == 409
    assert "cannot start another one" in problem.detail


def test_a_service_does_not_load_what_only_simulations_need() -> None:
    code = "import sys, api.serving.serving, api.serving.composition; print('httpx' in sys.modules)"

    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    assert done.stdout == "False\n"
