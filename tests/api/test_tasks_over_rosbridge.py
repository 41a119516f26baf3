"""The task planner for a client of rosbridge: files by name, waypoints, and what is refused."""

from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI

from api.app import close_workers, create_app
from api.rosbridge.clients import rosbridge_clients
from service.files.waypoint_folder import WaypointFolder
from service.ros.interface.settings import InterfaceSettings
from service.supervisor import Supervisor
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.rosbridge import RosbridgeClient

LINE = "0,0,0\n5,0,0\n20,0,0\n"
STATUSES = {0: "NO_TASK", 1: "PAUSED_TASK", 2: "RUNNING_TASK"}


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def supervisor(clock: ManualClock) -> AsyncIterator[Supervisor]:
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        yield supervisor


@pytest.fixture
async def app(supervisor: Supervisor, tmp_path: Path) -> AsyncIterator[FastAPI]:
    """The service of a robot with one track in its folder, and another one beside that."""
    folder = tmp_path / "tracks"
    folder.mkdir()
    (folder / "line.csv").write_text(LINE)
    (tmp_path / "other.csv").write_text(LINE)
    settings = InterfaceSettings(folder=WaypointFolder(folder))
    app = create_app(supervisor, allowed_hosts=[], interface=settings)
    # In a thread, for which virtual time does not wait.
    await rosbridge_clients(app).bridge()
    # Starts its process, for which a client waits too long on a busy machine.
    await app.state.worker.call(len, "")
    yield app
    await close_workers(app)


async def call(client: RosbridgeClient, service: str, args: object = None) -> dict[str, Any]:
    client.ask("call_service", service=service, args=args or {}, id="call:1")
    response = await client.next("service_response")
    assert response["id"] == "call:1"
    return response


async def status_of(client: RosbridgeClient, clock: ManualClock) -> str:
    """Return the task status that is published next, which the old name of its type gets too."""
    type_name = "gem_state_msgs/TaskPlannerStatus"
    client.ask("subscribe", topic="/task_planner_status", type=type_name, id="s")
    await clock.advance(0.1)
    message = await client.next("publish")
    client.ask("unsubscribe", topic="/task_planner_status", id="s")
    await clock.advance(0.1)
    client.frames()
    return STATUSES[message["msg"]["status"]]


async def test_a_file_is_driven_and_cancelled(app: FastAPI, clock: ManualClock) -> None:
    async with RosbridgeClient(app) as client:
        assert await status_of(client, clock) == "NO_TASK"

        served = await call(client, "/serve_waypoints", {"file": "line.csv"})
        assert served["result"] is True
        assert served["values"] == {"success": True, "message": "", "task": "t1"}
        assert await status_of(client, clock) == "RUNNING_TASK"

        cancelled = await call(client, "/cancel_tasks")
        assert cancelled["values"] == {}
        assert await status_of(client, clock) == "NO_TASK"


async def test_waypoints_are_driven_also_where_there_are_many(
    app: FastAPI, supervisor: Supervisor
) -> None:
    for count in (21, 800):
        waypoints = [{"x_m": x * 0.5, "y_m": 0.0, "yaw_rad": 0.0} for x in range(count)]
        async with RosbridgeClient(app) as client:
            asked = {"waypoints": waypoints, "controller": "stanley"}
            served = await call(client, "/drive_waypoints", asked)

        task = supervisor.core.driving.current_task
        assert task is not None
        assert served["values"] == {"success": True, "message": "", "task": task.id}
        assert (task.waypoint_count, task.controller) == (count, "stanley")


@pytest.mark.parametrize(
    "name",
    [
        "../other.csv",
        "/etc/passwd",
        "..%2fother.csv",
        "tracks/../../other.csv",
        "line.csv\0",
        "..\\other.csv",
    ],
)
async def test_no_file_beyond_the_folder_is_read(
    app: FastAPI, supervisor: Supervisor, name: str
) -> None:
    async with RosbridgeClient(app) as client:
        answer = await call(client, "/serve_waypoints", {"file": name})

    assert answer["values"]["success"] is False
    assert "waypoint file" in answer["values"]["message"]
    assert supervisor.core.driving.current_task is None


async def test_a_request_of_another_shape_is_told_what_is_wrong(app: FastAPI) -> None:
    async with RosbridgeClient(app) as client:
        answer = await call(client, "/serve_waypoints", {"file": 7})

    assert answer["result"] is False
    assert answer["values"] == "file must be a text, not 7"


async def test_viewers_find_the_services_and_their_types(app: FastAPI) -> None:
    async with RosbridgeClient(app) as client:
        told = await call(client, "/rosapi/service_type", {"service": "/drive_waypoints"})
        assert told["values"] == {"type": "pilothouse_msgs/srv/DriveWaypoints"}
        details = await call(client, "/rosapi/service_request_details", told["values"])

    assert [each["type"] for each in details["values"]["typedefs"]] == [
        "pilothouse_msgs/srv/DriveWaypoints_Request",
        "pilothouse_msgs/msg/Waypoint",
    ]
