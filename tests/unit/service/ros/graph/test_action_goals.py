"""Goals of an action, with servers and handles as rclpy has them."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable
from types import SimpleNamespace
from typing import Any

import pytest

from domain.controller import GoalOutcome
from domain.errors import InvalidValueError
from service.ros.graph.action_goals import MAX_GOALS, ActionGoals
from service.ros.graph.crossing import Crossing
from service.ros.graph.graph import AcceptedGoal, Fields
from service.ros.graph.sending import Sender
from tests.support.waiting import until

ACTION = "/navigate_waypoints"


class Feedback:
    """A message with one field."""

    progress = 0.0

    def get_fields_and_field_types(self) -> dict[str, str]:
        return {"progress": "double"}


class Result(Feedback):
    """Another one."""


class Handle:
    """A goal of rclpy."""

    def __init__(self, server: "Server", number: int) -> None:
        self.goal_id = SimpleNamespace(uuid=bytes([number]))
        self.status = "accepted"
        self.feedback: list[float] = []
        self._server = server

    def execute(self) -> None:
        self.status = "executing"
        self._server.notify_execute(self, None)

    def publish_feedback(self, feedback: Feedback) -> None:
        self.feedback.append(feedback.progress)

    def succeed(self) -> None:
        self.status = "succeeded"

    def abort(self) -> None:
        self.status = "aborted"

    def canceled(self) -> None:
        if self.status != "canceling":
            raise RuntimeError("goal_handle attempted invalid transition")
        self.status = "canceled"


class Server:
    """A server of rclpy: it executes a goal when it is told to."""

    def __init__(self) -> None:
        self.results: dict[bytes, float] = {}

    def notify_execute(
        self, handle: Handle, execute: Callable[[Handle], Result] | None = None
    ) -> None:
        assert execute is not None, "the goal has not ended"
        self.results[handle.goal_id.uuid] = execute(handle).progress


class Driver:
    """Drives goals, which are numbers."""

    def __init__(self) -> None:
        self.begun: list[tuple[int, AcceptedGoal]] = []
        self.canceled: list[AcceptedGoal] = []

    def read(self, message: Any) -> int:  # noqa: ANN401
        if message < 0:
            raise InvalidValueError("a goal is not negative")
        return int(message)

    def begin(self, goal: int, accepted: AcceptedGoal) -> None:
        self.begun.append((goal, accepted))

    def cancel(self, accepted: AcceptedGoal) -> None:
        self.canceled.append(accepted)


class Bench:
    """The goals of one action between rclpy and their driver."""

    def __init__(self) -> None:
        self.crossing, self.sender = Crossing(), Sender()
        self.crossing.open()
        self.server, self.driver = Server(), Driver()
        kind = SimpleNamespace(Feedback=Feedback, Result=Result)
        self.goals = ActionGoals(
            self.crossing, self.sender, ACTION, kind, self.driver, lambda do, *args: do(*args)
        )
        self.goals.attach(self.server)
        self.count = 0

    async def send(self, goal: int = 1) -> Handle:
        """Let a client send a goal that is accepted, and the driver begin it."""
        assert self.goals.judge(goal)
        self.count += 1
        handle = Handle(self.server, self.count)
        self.goals.accept(handle)
        await until(lambda: len(self.driver.begun) == self.count)
        return handle

    def end(self, end: GoalOutcome, result: Fields) -> None:
        self.driver.begun[-1][1].end(end, result)


@pytest.fixture
async def bench() -> AsyncIterator[Bench]:
    made = Bench()
    yield made
    await made.crossing.close()
    made.sender.stop()
    await asyncio.to_thread(made.sender.join, 1.0)


async def test_a_goal_is_executing_until_its_driver_ends_it(bench: Bench) -> None:
    handle = await bench.send(7)

    assert bench.driver.begun[0][0] == 7
    assert handle.status == "executing"
    bench.end(GoalOutcome.SUCCEEDED, {"progress": 1.0})
    assert handle.status == "succeeded"
    assert bench.server.results == {handle.goal_id.uuid: 1.0}


async def test_feedback_reaches_the_client(bench: Bench) -> None:
    handle = await bench.send()

    bench.driver.begun[0][1].feed_back({"progress": 0.25})

    await until(lambda: handle.feedback == [0.25])


async def test_a_cancel_reaches_the_driver_who_ends_the_goal(bench: Bench) -> None:
    handle = await bench.send()

    assert bench.goals.cancel(handle)
    handle.status = "canceling"
    await until(lambda: bench.driver.canceled == [bench.driver.begun[0][1]])
    bench.end(GoalOutcome.CANCELED, {})

    assert handle.status == "canceled"


async def test_a_cancel_of_a_goal_that_has_ended_is_rejected(bench: Bench) -> None:
    handle = await bench.send()
    bench.end(GoalOutcome.ABORTED, {})

    assert not bench.goals.cancel(handle)
    await bench.send()

    assert bench.driver.canceled == []


async def test_a_goal_that_rclpy_cannot_end_gets_its_result_all_the_same(
    bench: Bench, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)
    handle = await bench.send()

    bench.end(GoalOutcome.CANCELED, {"progress": 0.5})

    assert bench.server.results == {handle.goal_id.uuid: 0.5}
    assert "invalid transition" in caplog.text


def test_what_the_driver_cannot_read_is_rejected_and_logged(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def judge() -> bool:
        bench = Bench()
        judged = bench.goals.judge(-1)
        bench.sender.stop()
        return judged

    assert not asyncio.run(judge())
    assert "a goal is not negative" in caplog.text


async def test_more_goals_than_can_wait_are_rejected_until_one_ends(
    bench: Bench, caplog: pytest.LogCaptureFixture
) -> None:
    for _ in range(MAX_GOALS):
        await bench.send()

    assert not bench.goals.judge(1)
    assert f"{MAX_GOALS} have not ended" in caplog.text
    bench.end(GoalOutcome.ABORTED, {})
    assert bench.goals.judge(1)


async def test_no_goal_is_accepted_once_the_graph_is_closed(bench: Bench) -> None:
    await bench.crossing.close()

    assert not bench.goals.judge(1)
