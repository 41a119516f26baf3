"""Tasks that are begun over ROS, by a client in a process of its own, in the types that were built.

The vehicle is not there, so that a task waits; `tests/unit` drives it.
"""

import asyncio
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from tests.ros2.support.service import ros_robot

# Most of it for the compiler, which is not what is tested.
pytestmark = [pytest.mark.ros2, pytest.mark.timeout(900)]

CLIENT = Path(__file__).with_name("support") / "task_client.py"
LINE = "0,0,0\n5,0,0\n20,0,0\n"
NO_TASK, PAUSED_TASK = 0, 1


async def client(variables: Sequence[str], calls: Sequence[tuple[str, dict[str, object]]]) -> Any:  # noqa: ANN401
    """Return what the client printed at its end."""
    process = await asyncio.create_subprocess_exec(
        *("env", *variables, sys.executable, str(CLIENT), "1", json.dumps(calls)),
        stdout=asyncio.subprocess.PIPE,
    )
    printed, _ = await process.communicate()
    assert process.returncode == 0
    return json.loads(printed)


async def test_files_and_waypoints_become_tasks_and_a_path_becomes_none(
    interfaces: Sequence[str], tmp_path: Path
) -> None:
    folder = tmp_path / "tracks"
    folder.mkdir()
    (folder / "line.csv").write_text(LINE)
    (tmp_path / "other.csv").write_text(LINE)
    robot_file = tmp_path / "robot.yaml"
    robot_file.write_text("tasks: {folder: tracks}\n")
    calls: list[tuple[str, dict[str, object]]] = [
        ("/serve_waypoints", {"file": "../other.csv"}),
        ("/serve_waypoints", {"file": str(tmp_path / "other.csv")}),
        ("/serve_waypoints", {"file": "line.csv", "controller": "stanley", "speed_mps": 1.5}),
        ("/cancel_tasks", {}),
        ("/drive_waypoints", {"waypoints": [[0.5 * x, 0.0, 0.0] for x in range(2_000)]}),
    ]

    async with ros_robot("--robot", str(robot_file), environment=interfaces) as robot:
        told = await client(interfaces, calls)
        tasks = (await robot.get("/tasks"))["items"]
        events = await robot.events("audit.write")

    *refused, served, cancelled, driven = told["responses"]
    for response in refused:
        assert not response["success"]
        assert "must be the name of a file in the folder for waypoint files" in response["message"]
    assert served == {"success": True, "message": "", "task": "t1"}
    assert cancelled.keys() <= {"structure_needs_at_least_one_member"}
    assert driven == {"success": True, "message": "", "task": "t2"}
    assert [(task["id"], task["waypoint_count"]) for task in tasks] == [("t2", 2_000), ("t1", 3)]
    assert (tasks[1]["controller"], tasks[1]["speed_mps"]) == ("stanley", 1.5)
    statuses = [status for _, _, status in told["heard"]["task"]]
    changes = [b for a, b in zip([None, *statuses], statuses, strict=False) if a != b]
    assert changes == [NO_TASK, PAUSED_TASK, NO_TASK, PAUSED_TASK]
    written = [(event["data"]["path"], event["data"]["status"]) for event in events]
    assert written == [
        ("/serve_waypoints", 409),
        ("/serve_waypoints", 409),
        ("/serve_waypoints", 200),
        ("/cancel_tasks", 200),
        ("/drive_waypoints", 200),
    ]
