"""An action server in a graph in memory, honest or not."""

import asyncio
from dataclasses import dataclass, field
from typing import Any

from service.ros.graph.graph import Fields
from tests.support.ros_graph import FakeGraph

SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
"""Source: action_msgs/msg/GoalStatus."""
NONE, REJECTED, UNKNOWN_GOAL, TERMINATED = 0, 1, 2, 3
"""Source: action_msgs/srv/CancelGoal."""


@dataclass
class TakenGoal:
    """A goal that the server was sent."""

    id: list[int]
    fields: Fields
    ended: asyncio.Future[Fields] = field(
        default_factory=lambda: asyncio.get_running_loop().create_future()
    )


class FakeActionServer:
    """The three services of an action, and its feedback."""

    def __init__(self, graph: FakeGraph, action: str) -> None:
        self.accepts = True
        self.cancel_code: int | None = None
        """What it answers to every request to end a goal; None: as it should."""
        self.goals: list[TakenGoal] = []
        self.cancels: list[list[int]] = []
        """The ids that were asked back; zeros: all."""
        self._graph = graph
        self._action = f"{action}/_action"
        self._answers_held = asyncio.Event()
        self._answers_held.set()

    def appear(self) -> None:
        """Offer the services."""
        self._graph.offer(f"{self._action}/send_goal", self._take_goal)
        self._graph.offer(f"{self._action}/get_result", self._give_result)
        self._graph.offer(f"{self._action}/cancel_goal", self._cancel)

    def vanish(self) -> None:
        """Leave the graph."""
        for service in ("send_goal", "get_result", "cancel_goal"):
            self._graph.withdraw(f"{self._action}/{service}")

    def hold_answers(self, *, held: bool) -> None:
        """Let goal requests wait for their answer, or answer them."""
        (self._answers_held.clear if held else self._answers_held.set)()

    def report(self, goal: TakenGoal, **feedback: float) -> None:
        """Publish feedback of a goal."""
        message = {"goal_id": {"uuid": goal.id}, "feedback": feedback}
        self._graph.publish(f"{self._action}/feedback", message)

    def end(self, goal: TakenGoal, status: int, **result: Any) -> None:  # noqa: ANN401
        """End a goal."""
        goal.ended.set_result({"status": status, "result": result})

    async def _take_goal(self, request: Fields) -> Fields:
        self.goals.append(TakenGoal(request["goal_id"]["uuid"], request["goal"]))
        await self._answers_held.wait()
        return {"accepted": self.accepts}

    async def _give_result(self, request: Fields) -> Fields:
        known = self._find(request["goal_id"]["uuid"])
        return {"status": 0} if known is None else await asyncio.shield(known.ended)

    async def _cancel(self, request: Fields) -> Fields:
        asked = request["goal_info"]["goal_id"]["uuid"]
        self.cancels.append(asked)
        if self.cancel_code is not None:
            return {"return_code": self.cancel_code, "goals_canceling": []}
        live = [goal for goal in self.goals if not goal.ended.done()]
        ends = live if not any(asked) else [goal for goal in live if goal.id == asked]
        for goal in ends:
            self.end(goal, CANCELED, success=False, message="")
        code = NONE if ends or not any(asked) else UNKNOWN_GOAL
        infos = [{"goal_id": {"uuid": goal.id}} for goal in ends]
        return {"return_code": code, "goals_canceling": infos}

    def _find(self, uuid: list[int]) -> TakenGoal | None:
        return next((goal for goal in self.goals if goal.id == list(uuid)), None)
