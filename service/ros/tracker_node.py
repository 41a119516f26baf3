"""An action server that drives a vehicle in ROS 2 along waypoints: `pilothouse tracker`.

It carries messages; `domain/goal_server.py` decides.
"""

import asyncio
import logging
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from domain.arrays import np
from domain.commands import Drive
from domain.controller import GoalOutcome
from domain.goal_server import (
    GoalEnded,
    GoalMessage,
    GoalProgress,
    GoalServer,
    WaypointGoal,
)
from domain.identifiers import GoalId
from domain.inputs import DriveStatus, VehicleReport
from domain.navigation import NavigationSettings
from domain.tasks.settings import TaskSettings
from domain.timebase import Duration, seconds
from domain.vehicle import VehicleLimits
from service.clock import Clock
from service.files.ros2_block import Ros2Block
from service.pacing import Pacer
from service.ros.backend.vehicle import RosVehicle
from service.ros.graph.graph import AcceptedGoal, Lane, Message, Qos, RosGraph, UnknownTypeError
from service.running import run_forever

NODE = "tracker"
NAVIGATE_WAYPOINTS = "pilothouse_msgs/action/NavigateWaypoints"
SUPERVISED_BY = "/system_state"
"""Topic that Pilothouse publishes as long as it supervises."""

_TOLD: Duration = seconds(0.2)
_STOP_WITHIN: Duration = seconds(3.0)
"""Time in which a vehicle stops along its path when the tracker ends."""

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class TrackerSettings:
    """What `pilothouse tracker` drives, and how."""

    action: str
    """Full name."""
    controller: str
    """Name of the path tracker."""
    topics: Ros2Block
    """Odometry and drive commands; both are there."""
    limits: VehicleLimits
    tasks: TaskSettings
    navigation: NavigationSettings
    supervised_within: Duration
    """A supervisor that was heard and is silent for longer is gone."""


class TrackerNode:
    """Offers the action once there is a pose and commands arrive, and drives one goal at a time."""

    def __init__(self, settings: TrackerSettings, graph: RosGraph, clock: Clock) -> None:
        """Prepare; `run` joins in.

        Args:
            settings: What is driven, and how.
            graph: The ROS 2 graph.
            clock: Monotonic.
        """
        self._settings = settings
        self._graph = graph
        self._clock = clock
        self._server = GoalServer(
            settings.limits,
            settings.tasks,
            settings.navigation,
            settings.controller,
            settings.supervised_within,
        )
        self._vehicle = RosVehicle(settings.topics, settings.limits, graph, clock, owner=NODE)
        self._pacer = Pacer[GoalMessage](self._server, clock)
        self._accepted: dict[GoalId, AcceptedGoal] = {}
        self._arrive = False
        """Whether commands reach the vehicle."""
        self._has_pose = False
        self._is_offered = False

    async def run(self, stopping: asyncio.Event) -> None:
        """Drive goals until an event; then stop the vehicle, and abort the goal.

        Args:
            stopping: Ends it.

        Raises:
            UnknownTypeError: The type of the action, or of a topic, is not installed.
            ExceptionGroup: Of `TaskFailedError`: a task ended.
        """
        self._require_types()
        self._vehicle.start(self._hear)
        work = {"vehicle": self._vehicle.run(), "goals": self._pacer.run(self._do)}
        async with asyncio.TaskGroup() as tasks:
            running = tasks.create_task(run_forever(work), name="tracker")
            await stopping.wait()
            await self._stop()
            running.cancel()

    def _require_types(self) -> None:
        command = self._settings.topics.command
        for type_name in (NAVIGATE_WAYPOINTS, *(() if command is None else (command.type,))):
            if not self._graph.has_type(type_name):
                raise UnknownTypeError(type_name)

    async def _stop(self) -> None:
        """Abort the goal, and return when the vehicle stands or it is time to end."""
        now = self._clock.now()
        until = now + _STOP_WITHIN
        self._server.abort("the tracker ends", now)
        self._pacer.touch()
        while True:
            # At least once: the middleware sends the last messages in a thread of its own.
            await self._clock.sleep_until(self._clock.now() + _TOLD)
            if self._server.wake_at() is None or self._clock.now() >= until:
                return

    # --- for the graph ---------------------------------------------------------------------------

    def read(self, message: Message) -> WaypointGoal:
        """Return the goal of a client; called on another thread.

        Raises:
            InvalidValueError: It cannot be driven.
        """
        waypoints = [(each.x_m, each.y_m, each.yaw_rad) for each in message.waypoints]
        return WaypointGoal.checked(
            np.array(waypoints, dtype=np.float64).reshape(-1, 3),
            int(message.start_index),
            float(message.speed_mps),
            self._settings.limits,
        )

    def begin(self, goal: WaypointGoal, accepted: AcceptedGoal) -> None:
        """Drive a goal, in place of the one before."""
        number = self._server.begin(goal, self._clock.now())
        self._accepted[number] = accepted
        log.info(
            "goal %d: %d waypoints from %d on, at most %.2f m/s",
            number,
            goal.path.count,
            goal.start_index,
            goal.speed_mps,
        )
        self._pacer.touch()

    def cancel(self, accepted: AcceptedGoal) -> None:
        """Stop the vehicle, and end the goal then."""
        for number, each in self._accepted.items():
            if each is accepted:
                log.info("goal %d: cancel", number)
                self._server.cancel(number, self._clock.now())
        self._pacer.touch()

    # --- inside ----------------------------------------------------------------------------------

    def _hear(self, message: VehicleReport | DriveStatus) -> None:
        now = self._clock.now()
        if isinstance(message, VehicleReport):
            self._server.report(message, now)
            self._has_pose = True
        else:
            self._server.note_drive(message, now)
            self._pacer.touch()
            self._arrive = message.available
        if self._arrive and self._has_pose and not self._is_offered:
            self._offer()

    def _offer(self) -> None:
        self._is_offered = True
        settings = self._settings
        node = self._graph.node(NODE, Lane.GATEWAY)
        node.serve_action(settings.action, NAVIGATE_WAYPOINTS, self)
        node.subscribe(
            SUPERVISED_BY, "pilothouse_msgs/msg/SystemState", Qos.SENSOR, _came, self._supervised
        )
        log.info("ready: %s drives the goals of %s", settings.controller, settings.action)

    def _supervised(self, _: bool) -> None:
        self._server.hear_supervisor(self._clock.now())

    def _do(self, message: GoalMessage) -> None:
        match message:
            case Drive():
                self._vehicle.send(message)
            case GoalProgress():
                self._accepted[message.goal].feed_back(
                    {"target_index": message.target_index, "progress": message.progress}
                )
            case GoalEnded():
                log.info("goal %d: %s", message.goal, _WORDS[message.end] + message.message)
                result = {
                    "success": message.end is GoalOutcome.SUCCEEDED,
                    "message": message.message,
                }
                self._accepted.pop(message.goal).end(message.end, result)


def _came(_: Message) -> bool:
    """Take nothing from a message but that it came."""
    return True


_WORDS: Mapping[GoalOutcome, str] = MappingProxyType(
    {
        GoalOutcome.SUCCEEDED: "succeeded",
        GoalOutcome.ABORTED: "aborted: ",
        GoalOutcome.CANCELED: "",
    }
)
