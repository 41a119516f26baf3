"""The action server with a vehicle in a graph in memory, in virtual time."""

import asyncio
import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import pytest

from domain.controller import GoalOutcome
from domain.navigation import NavigationSettings
from domain.simulation.vehicle import SimulatedVehicle
from domain.simulation.vehicle_settings import Plant, VehicleSettings
from domain.tasks.settings import TaskSettings
from domain.timebase import seconds
from domain.vehicle import DriveCommand, Pose, VehicleLimits
from service.files.ros2_block import CommandBlock, CommandType, OdometryBlock, Ros2Block
from service.ros.graph.graph import Lane, UnknownTypeError
from service.ros.tracker_node import NAVIGATE_WAYPOINTS, TrackerNode, TrackerSettings
from tests.support.manual_clock import ManualClock
from tests.support.ros_graph import FakeGoal, FakeGraph

ACTION = "/navigate_waypoints"
LIMITS = VehicleLimits()
ACKERMANN: CommandType = "ackermann_msgs/msg/AckermannDrive"
SETTINGS = TrackerSettings(
    ACTION,
    "pure_pursuit",
    Ros2Block(
        odometry=OdometryBlock(topic="/odom"),
        command=CommandBlock(topic="/drive", type=ACKERMANN),
    ),
    LIMITS,
    TaskSettings(),
    NavigationSettings(),
    seconds(1.0),
)


def line(length_m: float = 20.0) -> list[dict[str, float]]:
    return [{"x_m": float(x), "y_m": 0.0, "yaw_rad": 0.0} for x in range(round(length_m) + 1)]


class Street:
    """A vehicle in the graph, and the tracker that drives it."""

    def __init__(self, graph: FakeGraph) -> None:
        self.graph, self.clock = graph, graph.clock
        settings = VehicleSettings(Pose(0.0, 0.0, 0.0), Plant(braking_mps2=2.0), LIMITS)
        self.vehicle = SimulatedVehicle(settings, graph.clock.now())
        self.odometry = True
        self._heard = 0

    async def stay(self, by_s: float) -> None:
        """Let time pass, in which the vehicle drives as it is told."""
        for _ in range(round(by_s / 0.05)):
            await self.clock.advance(0.05)
            now = self.clock.now()
            for told in self.graph.published("/drive")[self._heard :]:
                command = DriveCommand(told["speed"], told["steering_angle"])
                self.vehicle.drive(command, now)
            self._heard = len(self.graph.published("/drive"))
            self.vehicle.advance(now)
            if self.odometry:
                self.graph.publish("/odom", self._where())

    def _where(self) -> dict[str, Any]:
        state = self.vehicle.state
        turn = {
            "x": 0.0,
            "y": 0.0,
            "z": math.sin(state.pose.yaw_rad / 2),
            "w": math.cos(state.pose.yaw_rad / 2),
        }
        place = {"x": state.pose.x_m, "y": state.pose.y_m, "z": 0.0}
        return {
            "pose": {"pose": {"position": place, "orientation": turn}},
            "twist": {"twist": {"linear": {"x": state.speed_mps}, "angular": {"z": 0.0}}},
        }

    def send(self, length_m: float = 20.0, **changed: Any) -> FakeGoal:  # noqa: ANN401
        goal = {"waypoints": line(length_m), "start_index": 0, "speed_mps": 2.8}
        return self.graph.send_goal(ACTION, goal | changed)

    @property
    def speed_mps(self) -> float:
        return self.vehicle.state.speed_mps

    @property
    def commanded_mps(self) -> float:
        return float(self.graph.published("/drive")[-1]["speed"])


@asynccontextmanager
async def tracker(graph: FakeGraph | None = None) -> AsyncIterator[Street]:
    """Run a tracker; it is stopped at the end of the context."""
    street = Street(graph or FakeGraph(ManualClock()))
    stopping = asyncio.Event()
    node = TrackerNode(SETTINGS, street.graph, street.clock)
    running = asyncio.create_task(node.run(stopping))
    try:
        await street.stay(0.5)
        yield street
    finally:
        stopping.set()
        await street.stay(4.0)
        await running
        await street.graph.close()


async def test_a_goal_is_driven_with_feedback_to_its_result() -> None:
    async with tracker() as street:
        goal = street.send()
        await street.stay(20)

    assert goal.ended == (GoalOutcome.SUCCEEDED, {"success": True, "message": ""})
    assert goal.feedback[-1]["target_index"] == 20
    assert goal.feedback[-1]["progress"] == pytest.approx(1.0, abs=0.05)
    assert street.commanded_mps == 0.0


async def test_a_cancel_stops_the_vehicle_and_ends_the_goal_as_canceled() -> None:
    async with tracker() as street:
        goal = street.send(100.0)
        await street.stay(4)
        goal.cancel()
        await street.stay(3)

        assert goal.ended == (GoalOutcome.CANCELED, {"success": False, "message": "canceled"})
        assert street.speed_mps == 0.0


async def test_the_cancel_of_another_goal_changes_nothing() -> None:
    async with tracker() as street:
        old = street.send(100.0)
        new = street.send(100.0)
        old.cancel()
        await street.stay(2)

        assert old.ended is not None
        assert old.ended[0] is GoalOutcome.ABORTED
        assert new.ended is None
        assert street.speed_mps > 1.0


async def test_a_goal_that_cannot_be_driven_is_rejected_and_the_other_goes_on() -> None:
    async with tracker() as street:
        good = street.send(100.0)
        await street.stay(2)
        bad = street.send(start_index=99)
        await street.stay(2)

        assert "start_index 99" in bad.rejected
        assert good.ended is None
        assert street.speed_mps > 1.0


@pytest.mark.parametrize("waypoints", [[], line(0.0)])
async def test_without_a_path_there_is_no_goal(waypoints: list[dict[str, float]]) -> None:
    async with tracker() as street:
        assert "waypoints" in street.send(waypoints=waypoints).rejected


async def test_without_odometry_a_goal_is_aborted_and_says_so() -> None:
    async with tracker() as street:
        street.odometry = False
        await street.stay(1)
        goal = street.send()
        await street.stay(0.2)

    assert goal.ended is not None
    assert goal.ended[0] is GoalOutcome.ABORTED
    assert "no pose" in goal.ended[1]["message"]
    assert street.commanded_mps == 0.0


async def test_a_goal_is_aborted_once_the_state_of_the_robot_is_heard_no_more() -> None:
    async with tracker() as street:
        await street.stay(0.1)
        street.graph.publish("/system_state", {"state": 0})
        goal = street.send(100.0)
        await street.stay(0.9)
        assert goal.ended is None
        await street.stay(0.3)

    assert goal.ended is not None
    assert goal.ended[0] is GoalOutcome.ABORTED
    assert "no word of the supervisor" in goal.ended[1]["message"]


async def test_at_the_end_the_vehicle_is_stopped_and_the_goal_aborted() -> None:
    async with tracker() as street:
        goal = street.send(100.0)
        await street.stay(4)
        assert street.speed_mps > 2.0

    assert goal.ended == (GoalOutcome.ABORTED, {"success": False, "message": "the tracker ends"})
    assert street.speed_mps == 0.0


async def test_the_action_is_offered_once_commands_reach_the_vehicle() -> None:
    graph = FakeGraph(ManualClock())
    graph.drive_trouble = "it is starting"
    async with tracker(graph) as street:
        assert graph.actions == {}
        graph.drive_outputs[0].fail("")
        await street.stay(0.1)

        assert list(graph.actions) == [ACTION]
        assert graph.types[ACTION] == NAVIGATE_WAYPOINTS


async def test_its_nodes_have_names_of_their_own_beside_those_of_a_service() -> None:
    async with tracker() as street:
        assert street.graph.nodes == {"tracker": Lane.GATEWAY, "tracker_vehicle": Lane.SENSORS}


@pytest.mark.parametrize("missing", [NAVIGATE_WAYPOINTS, ACKERMANN])
async def test_a_type_that_is_not_installed_is_named_before_anything_runs(missing: str) -> None:
    graph = FakeGraph(ManualClock(), missing=(missing,))

    with pytest.raises(UnknownTypeError, match=missing):
        await TrackerNode(SETTINGS, graph, graph.clock).run(asyncio.Event())

    assert graph.nodes == {}
