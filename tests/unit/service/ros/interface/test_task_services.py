"""The task planner over ROS: a file or waypoints are driven, held, and cancelled."""

import logging
import threading
from collections.abc import AsyncIterator
from pathlib import Path as FilePath
from typing import Any

import pytest

from domain.errors import InvalidValueError
from domain.inputs import HoldRequest
from domain.snapshot import TaskView
from service.files.waypoint_folder import WaypointFolder
from service.ros.interface.settings import InterfaceSettings
from tests.support.numpy_loads import numpy_not_loaded
from tests.support.ros_robot import OPERATOR, RosRobot, running_ros_robot

LINE = "0,0,0\n5,0,0\n20,0,0\n"
WAYPOINTS = [{"x_m": float(x), "y_m": 0.0, "yaw_rad": 0.0} for x in range(21)]
SERVE, DRIVE = "/serve_waypoints", "/drive_waypoints"


@pytest.fixture
async def robot(tmp_path: FilePath) -> AsyncIterator[RosRobot]:
    """A robot with one track in its folder."""
    folder = tmp_path / "tracks"
    folder.mkdir()
    (folder / "line.csv").write_text(LINE)
    (tmp_path / "secret.csv").write_text(LINE)
    settings = InterfaceSettings(folder=WaypointFolder(folder))
    async with running_ros_robot(settings=settings) as robot:
        yield robot


def folder_of(tmp_path: FilePath) -> FilePath:
    return tmp_path / "tracks"


def task_of(robot: RosRobot) -> TaskView:
    task = robot.supervisor.core.driving.current_task
    assert task is not None
    return task


def audited(robot: RosRobot) -> list[tuple[object, object, object]]:
    events = robot.supervisor.events.oldest_first()
    found = [event for event in events if event.kind == "audit.write"]
    return [(e.data["path"], e.data["status"], e.actor.label) for e in found]


async def test_a_file_is_driven_from_its_start_to_its_end(robot: RosRobot) -> None:
    status = robot.hear("/task_planner_status")

    response = await robot.call(SERVE, {"file": "line.csv"})
    await robot.clock.advance(60)

    assert response == {"success": True, "message": "", "task": "t1"}
    (ended,) = robot.supervisor.core.driving.tasks()
    assert (ended.status, ended.controller, ended.speed_mps) == ("SUCCEEDED", "pure_pursuit", 2.8)
    told = [message["status"] for message in status]
    # No task, running, no task.
    assert [a for a, b in zip(told, [None, *told], strict=False) if a != b] in ([2, 0], [0, 2, 0])
    assert audited(robot) == [(SERVE, 200, OPERATOR.label)]


@pytest.mark.parametrize(
    ("service", "request_"), [(SERVE, {"file": "line.csv"}), (DRIVE, {"waypoints": WAYPOINTS})]
)
async def test_the_first_task_makes_a_thread_load_numpy(
    robot: RosRobot, service: str, request_: dict[str, Any]
) -> None:
    with numpy_not_loaded() as numpy:
        responses = [await robot.call(service, request_) for _ in range(2)]

    assert [response["task"] for response in responses] == ["t1", "t2"]
    (thread,) = numpy.threads
    assert thread is not threading.current_thread()


async def test_waypoints_are_driven_as_the_request_says(robot: RosRobot) -> None:
    asked = {"waypoints": WAYPOINTS, "start_index": 3, "controller": "stanley", "speed_mps": 1.5}
    response = await robot.call(DRIVE, asked)

    task = task_of(robot)
    assert response == {"success": True, "message": "", "task": task.id}
    assert (task.start_index, task.controller, task.speed_mps) == (3, "stanley", 1.5)
    assert task.waypoint_count == len(WAYPOINTS)


async def test_a_newer_task_replaces_the_one_that_runs(robot: RosRobot) -> None:
    await robot.call(SERVE, {"file": "line.csv"})
    await robot.call(DRIVE, {"waypoints": WAYPOINTS})

    newest, first = robot.supervisor.core.driving.tasks()
    assert (newest.id, first.status) == (task_of(robot).id, "CANCELED")


async def test_a_task_is_taken_while_the_robot_is_held_and_waits(robot: RosRobot) -> None:
    robot.supervisor.submit(HoldRequest("operator", "loading", OPERATOR))

    response = await robot.call(SERVE, {"file": "line.csv"})
    await robot.clock.advance(2)

    assert response["success"]
    assert task_of(robot).status == "PAUSED"


async def test_a_task_is_cancelled(robot: RosRobot) -> None:
    await robot.call(SERVE, {"file": "line.csv"})
    await robot.call("/cancel_tasks")

    assert robot.supervisor.core.driving.current_task is None


@pytest.mark.parametrize(
    ("asked", "reason"),
    [
        ({}, "the name of a waypoint file is missing"),
        ({"file": "../secret.csv"}, "file must be the name of a file in the folder"),
        ({"file": "/etc/passwd"}, "file must be the name of a file in the folder"),
        (
            {"file": "lin.csv"},
            "there is no waypoint file 'lin.csv' (known: far.csv, line.csv, odd.csv, text.csv;"
            " did you mean line.csv?)",
        ),
        ({"file": "line.csv", "controller": "autopilot"}, "controller 'autopilot'"),
        ({"file": "line.csv", "speed_mps": 99.0}, "speed 99 m/s is not within"),
        ({"file": "line.csv", "speed_mps": -1.0}, "speed -1 m/s is not within"),
        ({"file": "line.csv", "speed_mps": float("nan")}, "speed nan m/s is not within"),
        ({"file": "line.csv", "start_index": 2}, "start_index 2 is not within 0 to 1"),
        ({"file": "line.csv", "start_index": 2**64 - 1}, "is not within 0 to 1"),
        ({"file": "far.csv"}, "the path begins 900.0 m from the vehicle"),
        ({"file": "odd.csv"}, "name the columns in the first line of the file, such as x,y,yaw"),
        ({"file": "text.csv"}, "the waypoints are invalid"),
    ],
)
async def test_a_file_that_cannot_be_driven_is_refused_with_the_reason(
    robot: RosRobot,
    tmp_path: FilePath,
    caplog: pytest.LogCaptureFixture,
    asked: dict[str, Any],
    reason: str,
) -> None:
    caplog.set_level(logging.INFO)
    (folder_of(tmp_path) / "far.csv").write_text("900,0,0\n920,0,0\n")
    (folder_of(tmp_path) / "odd.csv").write_text("0,0,45\n5,0,45\n9,0,45\n")
    (folder_of(tmp_path) / "text.csv").write_text("to whom it may concern\nhello\n")
    await robot.call(DRIVE, {"waypoints": WAYPOINTS})
    running = task_of(robot)

    response = await robot.call(SERVE, asked)

    assert (response["success"], response["task"]) == (False, "")
    assert reason in response["message"]
    assert f"requested by {OPERATOR.label}: {response['message']}" in caplog.text
    assert task_of(robot).id == running.id
    assert audited(robot)[-1] == (SERVE, 409, OPERATOR.label)


@pytest.mark.parametrize(
    ("asked", "reason"),
    [
        ({}, "a path has 2 to 100000 waypoints, not 0"),
        ({"waypoints": WAYPOINTS[:1]}, "a path has 2 to 100000 waypoints, not 1"),
        ({"waypoints": [{}] * 100_001}, "a path has 2 to 100000 waypoints, not 100001"),
        (
            {"waypoints": [*WAYPOINTS, {"x_m": float("inf"), "y_m": 0.0, "yaw_rad": 0.0}]},
            "waypoints/21/x_m: x_m must be finite",
        ),
        ({"waypoints": [{"x_m": 1.0}]}, "waypoints/0/y_m is missing"),
        ({"waypoints": WAYPOINTS, "start_index": 20}, "start_index 20 is not within 0 to 19"),
    ],
)
async def test_waypoints_that_cannot_be_driven_are_refused_with_the_reason(
    robot: RosRobot, asked: dict[str, Any], reason: str
) -> None:
    response = await robot.call(DRIVE, asked)

    assert (response["success"], response["task"]) == (False, "")
    assert reason in response["message"]
    assert robot.supervisor.core.driving.current_task is None
    assert audited(robot) == [(DRIVE, 409, OPERATOR.label)]


async def test_a_request_of_another_shape_is_an_error(robot: RosRobot) -> None:
    with pytest.raises(InvalidValueError, match="waypoints must be a list"):
        await robot.call(DRIVE, {"waypoints": "0,0"})
    with pytest.raises(InvalidValueError, match="no field 'path'"):
        await robot.call(SERVE, {"path": "line.csv"})

    assert audited(robot) == [(DRIVE, 422, OPERATOR.label), (SERVE, 422, OPERATOR.label)]


async def test_without_a_folder_no_file_is_driven() -> None:
    async with running_ros_robot() as robot:
        response = await robot.call(SERVE, {"file": "line.csv"})

    assert not response["success"]
    assert response["message"] == (
        "this robot has no folder for waypoint files"
        " (name one in the robot file: tasks: {folder: tracks})"
    )


async def test_what_the_reader_warns_of_is_in_the_log(
    robot: RosRobot, tmp_path: FilePath, caplog: pytest.LogCaptureFixture
) -> None:
    (folder_of(tmp_path) / "zero.csv").write_text("0,0,0\n0,5,0\n0,20,0\n")

    assert (await robot.call(SERVE, {"file": "zero.csv"}))["success"]

    (record,) = caplog.records
    assert record.getMessage().startswith("t1 of zero.csv: all headings are 0")
