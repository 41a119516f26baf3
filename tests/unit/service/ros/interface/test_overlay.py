"""What is drawn of the robot, as somebody sees it who listens."""

from typing import Any

import pytest

from domain.inputs import CancelTaskRequest, EmergencyStopRequest, HoldRequest, Reading, TaskRequest
from service.ros.interface.settings import InterfaceSettings
from tests.support.paths import straight
from tests.support.ros_robot import RosRobot, running_ros_robot

OVERLAY, PATH = "/pilothouse/overlay", "/pilothouse/path"
DONE, AHEAD, LOOKAHEAD, VEHICLE, TEXT = range(5)
ADD, DELETE = 0, 2


async def drive(robot: RosRobot, length_m: float = 100.0) -> None:
    """Begin to drive along a straight line."""
    await robot.clock.advance(1)
    robot.supervisor.submit(TaskRequest(straight(length_m), 0, "pure_pursuit", 1.0))
    await robot.clock.advance(1)


def shown(message: Any) -> dict[int, Any]:  # noqa: ANN401  # as in JSON
    """Return the markers that are drawn, by their number."""
    return {each["id"]: each for each in message["markers"] if each["action"] == ADD}


async def test_a_robot_without_a_task_is_a_vehicle_and_a_text(robot: RosRobot) -> None:
    heard = robot.hear(OVERLAY)

    await robot.clock.advance(1)

    markers = shown(heard[-1])
    assert {*markers} == {VEHICLE, TEXT}
    assert {each["id"] for each in heard[-1]["markers"]} == {DONE, AHEAD, LOOKAHEAD, VEHICLE, TEXT}
    assert markers[TEXT]["text"] == "IDLE, 0.0 m/s"
    # The middle of the body of a GEM e2, whose rear axle is at the origin.
    assert markers[VEHICLE]["pose"]["position"]["x"] == pytest.approx(2.45 / 2 - 0.35)
    assert markers[VEHICLE]["scale"] == {"x": 2.45, "y": 1.70, "z": 2.08}


async def test_a_drive_is_drawn_with_what_is_done_and_what_is_ahead(robot: RosRobot) -> None:
    heard = robot.hear(OVERLAY)
    await drive(robot)
    await robot.clock.advance(20)

    markers = shown(heard[-1])
    task = robot.supervisor.core.driving.latest_task
    assert task is not None
    rear_m = task.distance_m

    assert rear_m > 10
    assert markers[DONE]["points"][0]["x"] == 0.0
    assert markers[DONE]["points"][-1] == markers[AHEAD]["points"][0]
    assert markers[AHEAD]["points"][0]["x"] == pytest.approx(rear_m, abs=0.5)
    assert markers[AHEAD]["points"][-1]["x"] == 100.0
    assert markers[LOOKAHEAD]["pose"]["position"]["x"] > rear_m


async def test_the_text_tells_the_task_and_why_it_is_held(robot: RosRobot) -> None:
    heard = robot.hear(OVERLAY)
    await drive(robot)
    robot.supervisor.submit(HoldRequest("operator", "lunch"))
    await robot.clock.advance(5)

    state, task, reason = shown(heard[-1])[TEXT]["text"].splitlines()

    assert state == "RUNNING, 0.0 m/s"
    assert task.startswith("task t1 PAUSED, ")
    assert task.endswith("% of 100 m")
    assert "lunch" in reason


async def test_the_text_tells_errors_and_is_red(robot: RosRobot) -> None:
    heard = robot.hear(OVERLAY)
    await robot.clock.advance(1)
    robot.supervisor.readings.submit([Reading("battery_level", 0.2)])
    await robot.clock.advance(1)

    text = shown(heard[-1])[TEXT]

    state, error = text["text"].splitlines()
    assert state == "ERROR, 0.0 m/s"
    assert error == "BATTERY_LOW: battery 20 % is below 50 %"
    assert text["color"]["r"] > text["color"]["g"]


async def test_a_moving_robot_is_drawn_five_times_a_second(robot: RosRobot) -> None:
    await drive(robot)
    heard = robot.hear(OVERLAY)

    await robot.clock.advance(10)

    assert len(heard) == pytest.approx(50, abs=1)


async def test_a_robot_at_rest_is_drawn_once_a_second(robot: RosRobot) -> None:
    await robot.clock.advance(1)
    heard = robot.hear(OVERLAY)

    await robot.clock.advance(10)

    assert len(heard) == pytest.approx(10, abs=1)


async def test_a_change_is_drawn_within_a_fifth_of_a_second(robot: RosRobot) -> None:
    heard = robot.hear(OVERLAY)
    await robot.clock.advance(1.3)
    robot.supervisor.submit(EmergencyStopRequest(engaged=True, reason="smoke"))
    await robot.clock.advance(0.2)

    assert shown(heard[-1])[TEXT]["text"].startswith("ERROR")


async def test_the_path_of_a_task_is_told_once(robot: RosRobot) -> None:
    heard = robot.hear(PATH)
    await drive(robot)
    await robot.clock.advance(10)

    nothing, path = heard

    assert nothing["poses"] == []
    assert [each["pose"]["position"]["x"] for each in path["poses"]] == [0.0, 100.0]
    assert path["header"]["frame_id"] == "map"


async def test_the_path_is_gone_with_its_task(robot: RosRobot) -> None:
    heard, markers = robot.hear(PATH), robot.hear(OVERLAY)
    await drive(robot)
    robot.supervisor.submit(CancelTaskRequest())
    await robot.clock.advance(5)

    assert [len(each["poses"]) for each in heard] == [0, 2, 0]
    assert {DONE, AHEAD, LOOKAHEAD}.isdisjoint(shown(markers[-1]))


async def test_who_comes_late_gets_the_path_at_once(robot: RosRobot) -> None:
    robot.hear(PATH)
    await drive(robot)

    (path,) = robot.hear(PATH)

    assert len(path["poses"]) == 2


async def test_who_comes_when_nobody_listened_gets_the_path_with_the_next_frames(
    robot: RosRobot,
) -> None:
    await drive(robot)
    heard = robot.hear(PATH)
    assert not heard

    await robot.clock.advance(0.2)

    assert [len(each["poses"]) for each in heard] == [2]


async def test_the_frame_is_that_of_the_robot_file() -> None:
    async with running_ros_robot(settings=InterfaceSettings(frame_id="odom")) as robot:
        heard = robot.hear(OVERLAY)

        await robot.clock.advance(0.1)

    assert {each["header"]["frame_id"] for each in heard[-1]["markers"]} == {"odom"}


def test_both_belong_to_the_own_node_and_are_made_on_demand() -> None:
    topics = RosRobot().interface.topics

    assert {
        name: (topics[name].type, topics[name].node, topics[name].latched, topics[name].on_demand)
        for name in (OVERLAY, PATH)
    } == {
        OVERLAY: ("visualization_msgs/msg/MarkerArray", "pilothouse", False, True),
        PATH: ("nav_msgs/msg/Path", "pilothouse", True, True),
    }
