"""The goals of an action of ours, from when a client sends them to their end; imports no ROS.

rclpy runs one callback per goal, in which a goal ends when it returns, and busy-waits if that
awaits anything. So nothing is executed there until a goal has ended, on the event loop's thread.
"""

import logging
import threading
from collections.abc import Callable
from functools import partial
from typing import Any, Generic

from domain.controller import GoalOutcome
from domain.errors import InvalidValueError
from service.ros.graph.conversion import fill
from service.ros.graph.crossing import Crossing
from service.ros.graph.graph import ActionHandler, Fields, GoalT, Message
from service.ros.graph.sending import Sender

MAX_GOALS = 8
"""Most goals of an action that have not ended; further ones are rejected."""

_TRANSITIONS = {
    GoalOutcome.SUCCEEDED: "succeed",
    GoalOutcome.ABORTED: "abort",
    GoalOutcome.CANCELED: "canceled",
}
_log = logging.getLogger(__name__)


class ActionGoals(Generic[GoalT]):
    """Passes goals and cancels to the event loop; `judge`, `accept` and `cancel` are for rclpy."""

    def __init__(
        self,
        crossing: Crossing,
        sender: Sender,
        action: str,
        kind: Any,  # noqa: ANN401  # a class of ROS
        handler: ActionHandler[GoalT],
        do: Callable[..., None],
    ) -> None:
        """Prepare; `attach` connects it to the server of rclpy.

        Args:
            crossing: Passes goals to the event loop.
            sender: Publishes feedback.
            action: Full name.
            kind: Type of the action.
            handler: Drives the goals.
            do: Calls a function with arguments on the thread that receives goals.
        """
        self._crossing = crossing
        self._sender = sender
        self._action = action
        self._kind = kind
        self._handler = handler
        self._do = do
        self._read: GoalT | None = None
        self._room = threading.BoundedSemaphore(MAX_GOALS)
        self._begun: dict[bytes, _Goal[GoalT]] = {}
        self._execute: Callable[[Any, Callable[[Any], Message]], None]

    def attach(self, server: Any) -> None:  # noqa: ANN401  # rclpy's
        """Take over when the goals of a server are executed."""
        self._execute = server.notify_execute
        server.notify_execute = _wait

    def judge(self, request: Message) -> bool:
        """Tell whether a goal is accepted."""
        try:
            goal = self._handler.read(request)
        except InvalidValueError as error:
            _log.warning("%s: a goal is rejected: %s", self._action, error)
            return False
        if self._crossing.closed:
            return False
        if not self._room.acquire(blocking=False):
            _log.warning("%s: a goal is rejected: %d have not ended", self._action, MAX_GOALS)
            return False
        self._read = goal
        return True

    def accept(self, handle: Any) -> None:  # noqa: ANN401  # rclpy's
        """Begin the goal that was judged last."""
        assert self._read is not None
        read, self._read = self._read, None
        goal = _Goal(self, handle)
        self._begun[bytes(handle.goal_id.uuid)] = goal
        handle.execute()
        self._crossing.post(self._handler.begin, read, goal)

    def cancel(self, handle: Any) -> bool:  # noqa: ANN401  # rclpy's
        """Pass a cancel on; return whether the goal has not ended yet."""
        goal = self._begun.get(bytes(handle.goal_id.uuid))
        if goal is not None:
            self._crossing.post(self._handler.cancel, goal)
        return goal is not None

    def feed_back(self, handle: Any, fields: Fields) -> None:  # noqa: ANN401  # rclpy's
        """Publish feedback, and return at once."""
        self._sender.send(self._action, partial(self._publish, handle), fields)

    def end(self, handle: Any, end: GoalOutcome, fields: Fields) -> None:  # noqa: ANN401  # rclpy's
        """End a goal with a result, and return at once."""
        result = self._kind.Result()
        fill(result, fields)
        self._do(self._finish, handle, end, result)

    def _publish(self, handle: Any, fields: Fields) -> None:  # noqa: ANN401  # rclpy's
        feedback = self._kind.Feedback()
        fill(feedback, fields)
        if not self._crossing.closed:
            handle.publish_feedback(feedback)

    def _finish(self, handle: Any, end: GoalOutcome, result: Message) -> None:  # noqa: ANN401
        del self._begun[bytes(handle.goal_id.uuid)]
        self._room.release()
        try:
            getattr(handle, _TRANSITIONS[end])()
        except RuntimeError as error:
            # rclpy raises RuntimeError; the result is sent all the same.
            _log.info("%s: could not tell the end of a goal: %s", self._action, error)
        self._execute(handle, lambda _: result)


class _Goal(Generic[GoalT]):
    """An `AcceptedGoal` of rclpy."""

    def __init__(self, goals: ActionGoals[GoalT], handle: Any) -> None:  # noqa: ANN401  # rclpy's
        self._goals = goals
        self._handle = handle

    def feed_back(self, feedback: Fields) -> None:
        """Publish feedback."""
        self._goals.feed_back(self._handle, feedback)

    def end(self, end: GoalOutcome, result: Fields) -> None:
        """End the goal."""
        self._goals.end(self._handle, end, result)


def _wait(_handle: object, _callback: object = None) -> None:
    """Execute nothing yet."""
