"""An external controller that is an action server; carries messages, and judges none of them.

An action consists of three services and two topics. Each goal has an id of ours, by which it can be
taken back whatever became of the request.
"""

import asyncio
import logging
import secrets
from collections.abc import Callable, Coroutine
from contextlib import suppress
from dataclasses import dataclass, field

from domain.commands import PreemptGoal, SendGoal
from domain.controller import (
    ControllerAnswer,
    ControllerFeedback,
    ControllerMessage,
    ControllerResult,
    ControllerStatus,
    GoalOutcome,
)
from domain.identifiers import GoalId
from domain.timebase import Duration, Instant, seconds
from service.clock import Clock
from service.files.ros2_block import NavigationBlock
from service.ros.backend.navigation_types import NAVIGATION_TYPES, Progress
from service.ros.graph.graph import Fields, Lane, Message, Qos, RosGraph

NODE = "pilothouse_navigation"

_LOOK_EVERY: Duration = seconds(0.5)
_FEEDBACK_EVERY: Duration = seconds(0.04)
"""Least period of feedback; a controller that gives it more often is thinned out."""
_CALL_S = 1.0
"""Timeout of a request that is answered at once, s."""
_ACCEPTED_S = 10.0
"""Timeout of a goal request, s: longer than the core waits."""
_RESULT_S = 60.0
"""After this time the result is asked for again, s: a controller that was started again says that
it does not know the goal."""
_END_S = 0.5
"""How long the end of the service waits for the controller to take goals back, s."""
_REJECTED, _UNKNOWN_GOAL = 1, 2
"""Source: action_msgs/srv/CancelGoal. A goal that is being canceled already counts as terminated
there, although it may still be driven."""
_LIVE = frozenset({1, 2, 3})
"""Accepted, executing and canceling. Source: action_msgs/msg/GoalStatus."""
_ENDS = {4: GoalOutcome.SUCCEEDED, 5: GoalOutcome.CANCELED, 6: GoalOutcome.ABORTED}
"""Source: action_msgs/msg/GoalStatus."""
_ALL_GOALS = bytes(16)

log = logging.getLogger(__name__)


@dataclass(slots=True)
class _Goal:
    """A goal that was sent, and has not ended as far as is known."""

    command: SendGoal
    id: bytes = field(default_factory=lambda: secrets.token_bytes(16))
    answered: asyncio.Event = field(default_factory=asyncio.Event)
    """Set once the request was answered, or is lost."""
    work: asyncio.Task[None] | None = None


class NavigationClient:
    """A `NavigationBackend` for one action of a ROS 2 graph."""

    def __init__(
        self, settings: NavigationBlock, frame_id: str, graph: RosGraph, clock: Clock
    ) -> None:
        """Prepare; `start` joins the graph.

        Args:
            settings: Which action, and its deadlines.
            frame_id: Frame of the waypoints.
            graph: Where the controller is.
            clock: Of the service.
        """
        self._settings = settings
        self._frame_id = frame_id
        self._type = NAVIGATION_TYPES[settings.type]
        self._graph = graph
        self._clock = clock
        self._goals: dict[GoalId, _Goal] = {}
        self._newest: _Goal | None = None
        self._live: frozenset[bytes] = frozenset()
        """The goals of all clients that the controller has not ended, as it said last."""
        self._feedback_due: Instant = 0
        self._status: ControllerStatus | None = None
        self._group: asyncio.TaskGroup | None = None
        self._deliver: Callable[[ControllerMessage], None]

    def start(self, deliver: Callable[[ControllerMessage], None]) -> None:
        """Make the clients; nothing is sent before `run`.

        Raises:
            UnknownTypeError: The type of the action is not installed.
        """
        self._deliver = deliver
        action, kind = f"{self._settings.action}/_action", self._settings.type
        node = self._graph.node(NODE, Lane.NAVIGATION)
        self._send_goal = node.client(f"{action}/send_goal", f"{kind}_SendGoal")
        self._get_result = node.client(f"{action}/get_result", f"{kind}_GetResult")
        self._cancel_goal = node.client(f"{action}/cancel_goal", "action_msgs/srv/CancelGoal")
        node.subscribe(
            f"{action}/status",
            "action_msgs/msg/GoalStatusArray",
            Qos.LATCHED,
            _live_goals,
            self._take_live_goals,
        )
        node.subscribe(
            f"{action}/feedback",
            f"{kind}_FeedbackMessage",
            Qos.SENSOR,
            self._pick_feedback,
            self._take_feedback,
        )

    async def run(self) -> None:
        """Look for the controller and talk to it until cancelled; then take its goals back."""
        try:
            async with asyncio.TaskGroup() as group:
                self._group = group
                try:
                    await self._look_forever()
                finally:
                    self._group = None
        finally:
            if self._goals:
                with suppress(TimeoutError):
                    await self._cancel(_ALL_GOALS, _END_S)

    def send(self, command: SendGoal | PreemptGoal, /) -> None:
        """Send a goal, or ask for its end, and return at once."""
        if self._group is None:
            # Before the start or after the end nothing takes the answer.
            return
        if isinstance(command, SendGoal):
            goal = self._goals[command.goal] = self._newest = _Goal(command)
            goal.work = self._begin(self._drive(goal), f"goal {command.goal}")
        elif command.goal in self._goals:
            self._begin(self._take_back(self._goals[command.goal]), f"end of goal {command.goal}")
        else:
            self._deliver(ControllerResult(command.goal, GoalOutcome.UNKNOWN))

    def _begin(self, work: Coroutine[object, object, None], name: str) -> asyncio.Task[None]:
        assert self._group is not None
        return self._group.create_task(work, name=name)

    # --- one goal --------------------------------------------------------------------------------

    async def _drive(self, goal: _Goal) -> None:
        """Send a goal, and tell what becomes of it."""
        command = goal.command

        def make() -> Fields:
            return {"goal_id": _uuid(goal.id), "goal": self._type.goal(command, self._frame_id)}

        try:
            response = await self._send_goal.call_large(make, _ACCEPTED_S)
        except TimeoutError:
            return
        finally:
            goal.answered.set()
        if not response.accepted:
            self._forget(goal)
            self._deliver(ControllerAnswer(command.goal, accepted=False))
            return
        self._deliver(ControllerAnswer(command.goal, accepted=True))
        response = await self._result_of(goal.id)
        self._end(goal, response)

    async def _result_of(self, goal_id: bytes) -> Message:
        while True:
            with suppress(TimeoutError):
                return await self._get_result.call({"goal_id": _uuid(goal_id)}, _RESULT_S)

    def _end(self, goal: _Goal, response: Message) -> None:
        self._forget(goal)
        end = _ENDS.get(response.status, GoalOutcome.UNKNOWN)
        why = ""
        if end in (GoalOutcome.SUCCEEDED, GoalOutcome.ABORTED):
            why = self._type.failure(response.result)
        if why:
            end = GoalOutcome.ABORTED
        self._deliver(ControllerResult(goal.command.goal, end, why))

    async def _take_back(self, goal: _Goal) -> None:
        """Ask for the end of a goal; whether it has ended its result shows."""
        # A request to end a goal may overtake the one that begins it.
        await goal.answered.wait()
        try:
            response = await self._cancel(goal.id, _CALL_S)
        except TimeoutError:
            return
        if self._goals.get(goal.command.goal) is not goal:
            return
        if response.return_code == _REJECTED:
            log.warning("%s: the controller refuses to end a goal", self._settings.action)
        elif response.return_code == _UNKNOWN_GOAL:
            self._forget(goal)
            self._deliver(ControllerResult(goal.command.goal, GoalOutcome.UNKNOWN))

    def _forget(self, goal: _Goal) -> None:
        self._goals.pop(goal.command.goal, None)
        if goal.work is not None and goal.work is not asyncio.current_task():
            goal.work.cancel()

    async def _cancel(self, goal_id: bytes, within_s: float) -> Message:
        """Ask for the end of a goal, or of all.

        Raises:
            TimeoutError: There was no answer in time.
        """
        request = {"goal_info": {"goal_id": _uuid(goal_id)}}
        return await self._cancel_goal.call(request, within_s)

    # --- feedback --------------------------------------------------------------------------------

    def _pick_feedback(self, message: Message) -> tuple[_Goal, Progress] | None:
        """Return what a feedback says; None: it is of another goal, or comes too soon."""
        goal, now = self._newest, self._clock.now()
        if goal is None or bytes(message.goal_id.uuid) != goal.id or now < self._feedback_due:
            return None
        self._feedback_due = now + _FEEDBACK_EVERY
        return goal, self._type.progress(message.feedback, goal.command)

    def _take_feedback(self, said: tuple[_Goal, Progress]) -> None:
        goal, (target_index, progress) = said
        if self._goals.get(goal.command.goal) is goal:
            self._deliver(ControllerFeedback(goal.command.goal, target_index, progress))

    # --- the controller itself -------------------------------------------------------------------

    async def _look_forever(self) -> None:
        while True:
            await self._look()
            await self._clock.sleep_until(self._clock.now() + _LOOK_EVERY)

    async def _look(self) -> None:
        """Tell whether there is a controller; one that appears has to end all goals first."""
        clients = (self._send_goal, self._get_result, self._cancel_goal)
        action = self._settings.action
        if not all(client.is_ready() for client in clients):
            self._tell(ControllerStatus(False, f"there is no controller at {action}"))
        elif self._status is None or not self._status.available:
            try:
                await self._end_all_goals()
            except TimeoutError:
                reason = f"the controller at {action} does not end the goals that it had before"
                self._tell(ControllerStatus(False, reason))
            else:
                self._tell(ControllerStatus(True))

    async def _end_all_goals(self) -> None:
        """Have the controller end what an earlier run of either of us left.

        Raises:
            TimeoutError: It did not confirm that in time.
        """
        response = await self._cancel(_ALL_GOALS, _CALL_S)
        canceling = {bytes(info.goal_id.uuid) for info in response.goals_canceling}
        # The response leaves out what is being canceled already.
        for goal_id in sorted(canceling | self._live):
            await self._get_result.call({"goal_id": _uuid(goal_id)}, _CALL_S)
        for goal in [*self._goals.values()]:
            self._forget(goal)

    def _take_live_goals(self, live: frozenset[bytes]) -> None:
        self._live = live

    def _tell(self, status: ControllerStatus) -> None:
        if status != self._status:
            self._status = status
            self._deliver(status)


def _uuid(goal_id: bytes) -> Fields:
    return {"uuid": [*goal_id]}


def _live_goals(message: Message) -> frozenset[bytes]:
    return frozenset(
        bytes(status.goal_info.goal_id.uuid)
        for status in message.status_list
        if status.status in _LIVE
    )
