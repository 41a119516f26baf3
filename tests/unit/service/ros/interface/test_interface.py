import logging
from typing import Any

import pytest

from domain.inputs import ModeRequest
from domain.state_and_mode import PartName
from service.event_log import EventLog
from service.ros.interface.interface import RosInterface
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock, settle
from tests.support.models import BASE
from tests.support.ros_robot import RosRobot, running_interface


def test_everything_is_found_by_its_full_name() -> None:
    interface = RosRobot().interface

    assert all(service.name == name for name, service in interface.services.items())
    assert all(topic.name == name for name, topic in interface.topics.items())
    assert all(heard.name == name for name, heard in interface.heard.items())
    assert len(interface.services) == 3 * (5 + 3) + 3
    assert len(interface.topics) == 3 * 4 + 3 + 2
    assert set(interface.heard) == {
        "/battery_level",
        "/estop",
        "/gps_accuracy",
        "/pilothouse/checkpoints",
        "/signal_strength",
        "/temperature",
    }


async def test_who_stops_to_listen_hears_no_more(robot: RosRobot) -> None:
    heard: list[Any] = []
    stop = robot.interface.listen("/system_state", heard.append)
    await robot.clock.advance(1.0)
    before = len(heard)

    stop()
    await robot.clock.advance(1.0)

    assert len(heard) == before > 0


async def test_a_topic_that_does_not_exist_cannot_be_listened_to(robot: RosRobot) -> None:
    with pytest.raises(KeyError):
        robot.hear("/odom")


async def test_nothing_is_told_while_it_does_not_run() -> None:
    robot = RosRobot()
    heard = robot.hear("/drive_base/mode_event")
    async with running(robot.supervisor):
        robot.supervisor.submit(ModeRequest(BASE, "FAST"))
        await robot.clock.advance(2.0)
        async with running_interface(robot.interface):
            robot.supervisor.submit(ModeRequest(BASE, "SLOW"))
            await robot.clock.advance(2.0)

    assert [event["goal_mode"]["label"] for event in heard] == ["SLOW"]


async def test_a_frame_is_told_once_however_often_something_happens(robot: RosRobot) -> None:
    heard = robot.hear("/system_state")
    await robot.clock.advance(0.01)
    before = len(heard)

    robot.supervisor.submit(ModeRequest(BASE, "FAST"))
    await robot.clock.advance(0.01)

    assert len(heard) == before


async def test_hundreds_of_events_at_once_are_all_told(robot: RosRobot) -> None:
    heard = robot.hear("/drive_base/mode_request_info")

    for number in range(500):
        robot.supervisor.submit(ModeRequest(BASE, ("FAST", "SLOW")[number % 2]))
    await settle()

    assert len(heard) == 500


async def test_events_that_are_forgotten_before_they_are_read_are_a_warning_and_no_end(
    caplog: pytest.LogCaptureFixture,
) -> None:
    clock = ManualClock()
    supervisor = make_supervisor(clock)
    supervisor.events = EventLog(capacity=5)
    interface = RosInterface(supervisor)
    heard: list[Any] = []
    interface.listen("/drive_base/mode_request_info", heard.append)
    async with running(supervisor), running_interface(interface):
        first = supervisor.events.newest + 1
        for number in range(10):
            supervisor.submit(ModeRequest(BASE, ("FAST", "SLOW")[number % 2]))
        await clock.advance(0.1)

    last = int(caplog.records[0].getMessage().split()[4])
    assert [(record.levelno, record.getMessage()) for record in caplog.records] == [
        (logging.WARNING, f"missed events {first} to {last}")
    ]
    assert heard[-1]["goal_mode"]["label"] == "SLOW"


async def test_who_missed_events_is_told_where_all_are_and_should_be_by_now() -> None:
    clock = ManualClock()
    supervisor = make_supervisor(clock)
    supervisor.events = EventLog(capacity=2)
    interface = RosInterface(supervisor)
    asked: list[Any] = []
    moved: list[Any] = []
    interface.listen("/actuation/mode_request_info", asked.append)
    interface.listen("/drive_base/transition_event", moved.append)
    async with running(supervisor), running_interface(interface):
        supervisor.submit(ModeRequest(PartName("actuation"), "PERFORMANCE"))
        await clock.advance(5)

    assert [message["goal_mode"]["label"] for message in asked] == ["PERFORMANCE"]
    assert moved[-1]["goal_state"]["label"] == "active"
