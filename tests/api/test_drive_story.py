"""The drive as an operator sees it: tasks over HTTP, frames over the WebSocket, in virtual time."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import pytest

from domain.commands import Drive
from domain.paths.path import Path
from domain.simulation.vehicle_settings import Plant, VehicleSettings
from service.example_tracks import track_text
from service.files.waypoint_file import read_waypoints_csv
from tests.support.http_operator import HttpOperator
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.paths import straight
from tests.support.websocket import WebSocketClient

LOOP = Path(read_waypoints_csv(track_text("loop")))
STRAIGHT = straight(30.0)
BESIDE = straight(30.0, y_m=1.0)
CAR = VehicleSettings(plant=Plant(acceleration_mps2=2.0, braking_mps2=2.0, steering_rate_radps=0.5))
"""Needs a second or more to stand still."""


class Operator(HttpOperator):
    """A robot with its operator: what is asked, and what is seen."""

    def __init__(self, robot: HttpRobot, stream: WebSocketClient) -> None:
        super().__init__(robot)
        self.stream = stream
        self.frames: list[dict[str, Any]] = []
        self.events: list[dict[str, Any]] = []

    async def advance(self, duration_s: float) -> None:
        """Let time pass a little at a time, as an operator who watches the stream."""
        for _ in range(round(duration_s / 0.05)):
            await super().advance(0.05)
            for frame in self.stream.frames():
                (self.events if frame["type"] == "event" else self.frames).append(frame)

    async def task(self) -> dict[str, Any]:
        """Return the task that was served last."""
        items = (await self.robot.get("/tasks"))["items"]
        return dict(items[0])

    def kinds(self) -> list[str]:
        """Return what happened to tasks and holds."""
        kinds = [event["kind"] for event in self.events]
        return [kind for kind in kinds if kind.startswith(("task.", "hold."))]

    def drives(self) -> list[float]:
        """Return the speeds that the vehicle was told so far."""
        return [c.command.speed_mps for c in self.robot.sent if isinstance(c, Drive)]


@pytest.fixture
async def drive() -> AsyncIterator[Operator]:
    async with driving() as found:
        yield found


@asynccontextmanager
async def driving(vehicle: VehicleSettings | None = CAR) -> AsyncIterator[Operator]:
    async with http_robot(vehicle=vehicle) as robot, WebSocketClient(robot.app) as stream:
        yield Operator(robot, stream)


async def test_the_loop_is_driven_through_an_estop_and_completed(drive: Operator) -> None:
    served = await drive.submit_task(LOOP, speed_mps=7)
    assert served["status"] == "RUNNING"
    await drive.advance(30)
    before = await drive.task()
    told = len(drive.robot.sent)

    state = await drive.read(estop=True)

    # In the very step that took the reading: no time has passed since.
    assert drive.drives()[-1] == 0.0
    assert len(drive.robot.sent) == told + 1
    assert (state["state"], state["errors"]) == ("ERROR", ["ESTOP"])
    assert state["task_status"] == "PAUSED_TASK"
    assert (await drive.task())["status"] == "PAUSING"

    await drive.advance(5)
    paused = await drive.task()
    assert paused["status"] == "PAUSED"
    assert paused["target_index"] >= before["target_index"]
    assert set(drive.drives()[told:]) == {0.0}, "nothing is driven while it is held"

    state = await drive.read(estop=False)
    await drive.advance(0.3)
    resumed = await drive.task()
    assert resumed["status"] == "RUNNING"
    assert resumed["target_index"] >= paused["target_index"]

    await drive.advance(130)
    done = await drive.task()
    assert (done["status"], done["progress"]) == ("SUCCEEDED", 1.0)
    assert drive.kinds() == [
        "task.requested",
        "task.served",
        "task.started",
        "hold.set",
        "task.pausing",
        "task.paused",
        "hold.released",
        "task.resumed",
        "task.succeeded",
    ]
    assert (await drive.robot.get("/system_state"))["state"] == "IDLE"


async def test_the_frame_of_the_error_shows_the_held_task_as_well(drive: Operator) -> None:
    await drive.submit_task(STRAIGHT)
    await drive.advance(2)
    drive.frames.clear()
    await drive.read(estop=True)
    await drive.advance(0.05)

    first = drive.frames[0]
    assert first["system_state"]["state"] == "ERROR"
    assert first["system_state"]["task_status"] == "PAUSED_TASK"
    assert first["task"]["status"] == "PAUSING"
    assert first["vehicle"]["command"]["speed_mps"] == 0.0


async def test_the_emergency_stop_is_told_when_the_vehicle_stands(drive: Operator) -> None:
    await drive.submit_task(STRAIGHT)
    await drive.advance(4)
    await drive.stop("child on the path")
    assert drive.drives()[-1] == 0.0
    assert (await drive.robot.get("/emergency_stop"))["standstill_at"] is None

    await drive.advance(3)
    stop = await drive.robot.get("/emergency_stop")
    assert stop["standstill_at"] > stop["since_at"]
    assert (await drive.task())["status"] == "PAUSED"

    await drive.release_stop("it is gone")
    await drive.advance(15)
    assert (await drive.task())["status"] == "SUCCEEDED"


async def test_an_operators_hold_outlives_the_task_that_it_held(drive: Operator) -> None:
    await drive.submit_task(STRAIGHT)
    await drive.advance(2)
    await drive.hold(reason="loading")
    await drive.advance(2)
    replaced = await drive.submit_task(BESIDE)
    assert (replaced["status"], replaced["reason"]) == ("PAUSED", "loading")
    assert (await drive.robot.get("/tasks/t1"))["reason"] == "replaced by t2"

    await drive.advance(3)
    assert (await drive.robot.get("/vehicle"))["speed_mps"] == 0.0
    await drive.release()
    await drive.advance(20)
    done = await drive.task()
    assert (done["id"], done["status"]) == ("t2", "SUCCEEDED")


async def test_a_robot_that_loses_its_pose_stops_and_goes_on_when_it_is_back(
    drive: Operator,
) -> None:
    await drive.submit_task(STRAIGHT)
    await drive.advance(3)
    drive.robot.backend.set_vehicle_fault("silent")
    await drive.advance(0.4)

    assert drive.drives()[-1] == 0.0
    holds = (await drive.robot.get("/holds"))["items"]
    assert [(hold["owner"], hold["reason"]) for hold in holds] == [
        ("vehicle", "no pose of the vehicle for 0.3 s")
    ]
    assert (await drive.task())["status"] == "PAUSING"
    assert (await drive.robot.get("/system_state"))["state"] == "RUNNING"

    await drive.advance(3)
    assert (await drive.task())["status"] == "PAUSING", "nobody has seen it stand"
    drive.robot.backend.set_vehicle_fault(None)
    await drive.advance(15)
    assert (await drive.task())["status"] == "SUCCEEDED"
    assert drive.kinds().count("task.resumed") == 1


async def test_a_task_canceled_while_it_pauses_leaves_nothing_behind(drive: Operator) -> None:
    await drive.submit_task(STRAIGHT)
    await drive.advance(4)
    await drive.read(estop=True)
    assert (await drive.task())["status"] == "PAUSING"
    await drive.cancel_task()
    canceled = await drive.task()
    assert (canceled["status"], canceled["reason"]) == ("CANCELED", "canceled")
    assert (await drive.robot.get("/system_state"))["task_status"] == "NO_TASK"

    await drive.read(estop=False)
    await drive.advance(3)
    assert (await drive.robot.get("/vehicle"))["speed_mps"] == 0.0
    assert (await drive.robot.http.get("/tasks/current")).status_code == 404
    assert "task.resumed" not in drive.kinds()


async def test_a_stop_in_the_same_instant_as_the_task_is_served_lets_nothing_move(
    drive: Operator,
) -> None:
    await drive.submit_task(STRAIGHT)
    await drive.read(estop=True)
    await drive.advance(1)

    assert (await drive.robot.get("/vehicle"))["pose"]["x_m"] == pytest.approx(0.0, abs=1e-3)
    assert (await drive.task())["status"] == "PAUSED"


async def test_a_silent_supervisor_lets_the_vehicle_stop_by_itself() -> None:
    async with driving() as drive:
        await drive.submit_task(STRAIGHT)
        await drive.advance(5)
        vehicle = drive.robot.backend.robot.vehicle
        assert vehicle.state.speed_mps > 2.0
        now = drive.robot.clock.now()
        vehicle.advance(now + 3_000_000_000)

        assert vehicle.state.speed_mps == 0.0
