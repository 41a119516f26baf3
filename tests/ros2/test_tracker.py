"""`pilothouse tracker` as a client of its action sees it, with a vehicle node: real processes."""

import signal
from collections.abc import Sequence

import pytest

from tests.ros2.support.links import Link
from tests.ros2.support.street import running, street
from tests.support.process import COMMAND

# Most of it for the interfaces, which are built by the first test that needs them.
pytestmark = [pytest.mark.ros2, pytest.mark.timeout(600)]


@pytest.mark.parametrize("tracker", ["pure_pursuit", "stanley"])
async def test_a_goal_is_canceled_and_goes_on_from_its_target_index(
    tracker: str, link: Link, interfaces: Sequence[str]
) -> None:
    async with street(link, interfaces, tracker) as on:
        on.client.send("first", 15)
        assert await on.client.accepted("first")
        await on.client.passed("first", 4)

        on.client.cancel("first")
        ended = await on.client.ended("first")

        assert ended == ("canceled", "canceled")
        await on.watch.stands()
        assert on.watch.commands[-1][0] == 0.0
        reached = int(on.watch.pose[0]) + 1

        on.client.send("second", 15, start_index=reached)
        ended = await on.client.ended("second")

        assert ended == ("succeeded", "")
        indices = [index for index, _ in on.client.of("second", "feedback")]
        assert min(indices) == reached
        assert on.client.of("second", "feedback")[-1][1] == pytest.approx(1.0, abs=0.05)
        assert on.watch.pose == pytest.approx((15.0, 0.0), abs=0.5)
        await on.watch.stands()


async def test_a_newer_goal_replaces_the_one_before(link: Link, interfaces: Sequence[str]) -> None:
    async with street(link, interfaces) as on:
        on.client.send("old", 50)
        await on.client.passed("old", 2)
        on.client.send("none", 50, start_index=99)
        assert not await on.client.accepted("none")
        reached = on.client.of("old", "feedback")[-1][0]
        driven = len(on.watch.commands)

        on.client.send("new", 50, start_index=reached)

        assert await on.client.ended("old") == ("aborted", "replaced by a newer goal")
        await on.client.passed("new", reached + 2)
        assert min(speed for speed, _ in on.watch.commands[driven:]) > 1.0
        assert "start_index 99 is not within 0 to 50" in on.tracker.text


async def test_a_vehicle_that_falls_silent_is_stopped_and_its_goal_aborted(
    link: Link, interfaces: Sequence[str]
) -> None:
    async with street(link, interfaces) as on:
        on.client.send("goal", 100)
        await on.watch.drives(on.told)

        await on.watch.parameters.set("vehicle", "odometry", False)

        assert await on.client.ended("goal") == ("aborted", "no pose of the vehicle for 2 s")
        assert on.watch.commands[-1][0] == 0.0
        await on.watch.parameters.set("vehicle", "odometry", True)
        await on.watch.stands()


async def test_a_tracker_that_is_ended_stops_the_vehicle_first(
    link: Link, interfaces: Sequence[str]
) -> None:
    async with street(link, interfaces) as on:
        on.client.send("goal", 100)
        await on.watch.drives(on.told)

        on.tracker.signal(signal.SIGTERM)

        assert await on.client.ended("goal") == ("aborted", "the tracker ends")
        assert await on.tracker.code() == 0
        assert on.watch.commands[-1][0] == 0.0
        await on.watch.stands()


async def test_a_tracker_that_is_killed_leaves_no_vehicle_driving(
    link: Link, interfaces: Sequence[str]
) -> None:
    async with street(link, interfaces) as on:
        # Without its own timeout, so that it is the process of the commands that stops it.
        await on.watch.parameters.set("vehicle", "command_timeout", 1e6)
        on.client.send("goal", 100)
        await on.watch.drives(on.told)

        on.tracker.signal(signal.SIGKILL)

        await on.watch.stands()
        assert on.watch.commands[-1][0] == 0.0


async def test_without_the_messages_it_says_what_is_missing() -> None:
    async with running(*COMMAND, "tracker") as tracker:
        code = await tracker.code()

    assert code == 1
    assert "pilothouse_msgs/action/NavigateWaypoints is not installed" in tracker.text
    assert "Traceback" not in tracker.text
