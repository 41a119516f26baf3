"""Goals travel to an action server, and what it says of them travels back."""

import asyncio
from collections.abc import AsyncIterator

import pytest

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
from service.files.ros2_block import NavigationBlock
from service.ros.backend.navigation_client import NavigationClient
from service.ros.graph.graph import UnknownTypeError
from tests.support.manual_clock import ManualClock, settle
from tests.support.paths import straight
from tests.support.ros_action import (
    ABORTED,
    NONE,
    REJECTED,
    SUCCEEDED,
    TERMINATED,
    UNKNOWN_GOAL,
    FakeActionServer,
    TakenGoal,
)
from tests.support.ros_graph import FakeGraph

ACTION = "/navigate_waypoints"
SETTINGS = NavigationBlock(action=ACTION)
ABSENT = ControllerStatus(False, f"there is no controller at {ACTION}")
HERE = ControllerStatus(True)


class World:
    """A client, and the server that it talks to."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.graph = FakeGraph(self.clock)
        self.server = FakeActionServer(self.graph, ACTION)
        self.client = NavigationClient(SETTINGS, "map", self.graph, self.clock)
        self.heard: list[ControllerMessage] = []
        self.client.start(self.heard.append)

    def send(self, goal: int = 1, start_index: int = 3) -> None:
        path = straight()
        self.client.send(SendGoal(GoalId(goal), path, 0, start_index, "pure_pursuit", 1.5))

    def take_back(self, goal: int = 1) -> None:
        self.client.send(PreemptGoal(GoalId(goal)))

    def news(self) -> list[ControllerMessage]:
        """Return what was heard since the last call."""
        heard, self.heard[:] = [*self.heard], []
        return heard


@pytest.fixture
async def world() -> AsyncIterator[World]:
    made = World()
    running = asyncio.create_task(made.client.run())
    await settle()
    yield made
    running.cancel()
    for _ in range(20):
        await made.clock.advance(0.1)
    await asyncio.gather(running, return_exceptions=True)
    await made.graph.close()


@pytest.fixture
async def ready(world: World) -> World:
    """Return a world whose server is there."""
    world.server.appear()
    await world.clock.advance(1)
    world.news()
    world.server.cancels.clear()
    return world


# --- the controller itself -----------------------------------------------------------------------


async def test_a_controller_that_appears_ends_all_goals_before_it_is_told(world: World) -> None:
    assert world.news() == [ABSENT]
    world.server.appear()
    await world.clock.advance(1)

    assert world.news() == [HERE]
    assert world.server.cancels == [[0] * 16]


async def test_one_that_does_not_end_them_is_told_and_asked_again(world: World) -> None:
    world.news()
    world.server.appear()

    async def silent(_: object) -> dict[str, object]:
        await asyncio.get_running_loop().create_future()
        return {}

    world.graph.offer(f"{ACTION}/_action/cancel_goal", silent)
    await world.clock.advance(3)
    (told,) = world.news()
    assert told == ControllerStatus(
        False, f"the controller at {ACTION} does not end the goals that it had before"
    )
    world.server.appear()
    await world.clock.advance(2)
    assert world.news() == [HERE]


async def test_a_controller_that_vanishes_is_told_once(ready: World) -> None:
    ready.server.vanish()
    await ready.clock.advance(3)
    assert ready.news() == [ABSENT]


async def test_a_type_that_is_not_installed_is_an_error_at_the_start() -> None:
    clock = ManualClock()
    graph = FakeGraph(clock, missing=("pilothouse_msgs/action/NavigateWaypoints_SendGoal",))
    with pytest.raises(UnknownTypeError, match="pilothouse_msgs"):
        NavigationClient(SETTINGS, "map", graph, clock).start(print)


# --- a goal --------------------------------------------------------------------------------------


async def test_a_goal_is_sent_with_all_waypoints_and_its_end_is_told(ready: World) -> None:
    ready.send()
    await ready.clock.advance(0.1)
    (goal,) = ready.server.goals
    assert len(goal.fields["waypoints"]) == 21
    assert goal.fields["waypoints"][4] == {"x_m": 4.0, "y_m": 0.0, "yaw_rad": 0.0}
    assert (goal.fields["start_index"], goal.fields["speed_mps"]) == (3, 1.5)
    assert ready.news() == [ControllerAnswer(GoalId(1), accepted=True)]

    ready.server.report(goal, target_index=5, progress=0.25)
    ready.server.end(goal, SUCCEEDED, success=True, message="")
    await ready.clock.advance(0.1)
    assert ready.news() == [
        ControllerFeedback(GoalId(1), 5, 0.25),
        ControllerResult(GoalId(1), GoalOutcome.SUCCEEDED),
    ]


async def test_a_rejected_goal_is_told(ready: World) -> None:
    ready.server.accepts = False
    ready.send()
    await ready.clock.advance(0.1)
    assert ready.news() == [ControllerAnswer(GoalId(1), accepted=False)]


@pytest.mark.parametrize("status", [ABORTED, SUCCEEDED])
async def test_a_goal_that_failed_is_told_with_the_reason(ready: World, status: int) -> None:
    ready.send()
    await ready.clock.advance(0.1)
    ready.server.end(ready.server.goals[0], status, success=False, message="an obstacle")
    await ready.clock.advance(0.1)
    assert ready.news()[1:] == [ControllerResult(GoalId(1), GoalOutcome.ABORTED, "an obstacle")]


async def test_feedback_that_comes_too_often_or_of_others_is_left_aside(ready: World) -> None:
    ready.send()
    await ready.clock.advance(0.1)
    ready.news()
    (goal,) = ready.server.goals
    for index in range(100):
        ready.server.report(goal, target_index=index, progress=0.0)
        await ready.clock.advance(0.001)
    ready.server.report(type(goal)(id=[7] * 16, fields={}), target_index=999, progress=0.0)
    assert len(ready.news()) == 3


# --- taken back ----------------------------------------------------------------------------------


async def test_a_goal_that_is_taken_back_ends_canceled(ready: World) -> None:
    ready.send()
    await ready.clock.advance(0.1)
    ready.take_back()
    await ready.clock.advance(0.1)
    assert ready.news()[1:] == [ControllerResult(GoalId(1), GoalOutcome.CANCELED)]
    assert ready.server.cancels == [ready.server.goals[0].id]


async def test_a_goal_is_taken_back_only_after_its_request_was_answered(ready: World) -> None:
    """A request to end a goal that overtakes the goal would end nothing, and be believed."""
    ready.server.hold_answers(held=True)
    ready.send()
    ready.take_back()
    await ready.clock.advance(0.2)
    assert ready.server.cancels == []

    ready.server.hold_answers(held=False)
    await ready.clock.advance(0.2)
    assert ready.news()[-1] == ControllerResult(GoalId(1), GoalOutcome.CANCELED)


async def test_a_goal_that_the_controller_does_not_have_is_over(ready: World) -> None:
    ready.send()
    await ready.clock.advance(0.1)
    ready.server.cancel_code = UNKNOWN_GOAL
    ready.take_back()
    await ready.clock.advance(0.1)
    assert ready.news()[1:] == [ControllerResult(GoalId(1), GoalOutcome.UNKNOWN)]
    ready.take_back()
    assert ready.news() == [ControllerResult(GoalId(1), GoalOutcome.UNKNOWN)]


async def test_a_goal_that_is_said_to_be_terminated_may_still_be_driven(ready: World) -> None:
    """So a server of ROS 2 answers to a second cancel, while the first is ignored."""
    ready.send()
    await ready.clock.advance(0.1)
    ready.news()
    ready.server.cancel_code = TERMINATED
    ready.take_back()
    await ready.clock.advance(2)
    assert ready.news() == []

    ready.server.end(ready.server.goals[0], ABORTED, success=False, message="stuck")
    await ready.clock.advance(0.1)
    assert ready.news() == [ControllerResult(GoalId(1), GoalOutcome.ABORTED, "stuck")]


async def test_a_controller_that_still_drives_a_goal_of_before_is_not_available(
    world: World,
) -> None:
    """Its answer to a request to end all goals leaves out what is being canceled already."""
    world.news()
    left = TakenGoal([9] * 16, {})
    world.server.goals.append(left)
    world.server.cancel_code = NONE
    info = {"goal_info": {"goal_id": {"uuid": left.id}}, "status": 3}
    world.graph.publish(f"{ACTION}/_action/status", {"status_list": [info]})
    world.server.appear()
    await world.clock.advance(3)
    (told,) = world.news()
    assert told.available is False  # type: ignore[union-attr]

    world.server.end(left, ABORTED, success=False, message="")
    world.graph.publish(f"{ACTION}/_action/status", {"status_list": [{**info, "status": 6}]})
    await world.clock.advance(2)
    assert world.news() == [HERE]


async def test_a_refusal_to_end_a_goal_is_logged_and_ends_nothing(
    ready: World, caplog: pytest.LogCaptureFixture
) -> None:
    ready.send()
    await ready.clock.advance(0.1)
    ready.server.cancel_code = REJECTED
    ready.take_back()
    await ready.clock.advance(0.1)
    assert len(ready.news()) == 1
    assert "refuses to end a goal" in caplog.text


async def test_a_service_that_ends_takes_its_goals_back() -> None:
    world = World()
    world.server.appear()
    running = asyncio.create_task(world.client.run())
    await world.clock.advance(1)
    world.send()
    await world.clock.advance(0.1)
    running.cancel()
    await world.clock.advance(1)

    assert world.server.cancels[-1] == [0] * 16
    assert world.server.goals[0].ended.done()
    await asyncio.gather(running, return_exceptions=True)
    world.send(2)
    await world.graph.close()
    assert len(world.server.goals) == 1
