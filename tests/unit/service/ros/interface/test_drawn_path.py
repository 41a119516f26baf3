from collections.abc import Sequence
from dataclasses import replace
from math import atan2, cos, pi, sin

import numpy as np
import pytest

from domain.identifiers import TaskId
from domain.paths.path import Path
from domain.snapshot import TaskView
from domain.tasks.task import Task
from service.ros.interface.drawn_path import MOST_POINTS, DrawnPath
from service.ros.interface.endpoints import Fields
from tests.support.paths import straight

HEADER = {"stamp": {"sec": 1, "nanosec": 2}, "frame_id": "map"}


def task_on(path: Path, start_index: int = 0) -> TaskView:
    """Return a task that has just begun."""
    return Task(TaskId("t1"), path, "pure_pursuit", 1.0, start_index, created_at=0, cause=1).view()


def drawn(path: Path, start_index: int = 0) -> DrawnPath:
    """Return a path whose points are found."""
    found = DrawnPath(task_on(path, start_index), path)
    while not found.is_done:
        found.go_on()
    return found


def corner() -> Path:
    """Return 20 m to the east and then 20 m to the north."""
    along = np.arange(0.0, 20.5, 0.5)
    x = np.concatenate((along, np.full(40, 20.0)))
    y = np.concatenate((np.zeros(41), along[1:]))
    return Path(np.column_stack((x, y, np.zeros_like(x))))


def places(points: Sequence[Fields]) -> list[tuple[float, float]]:
    """Return x and y of points."""
    return [(point["x"], point["y"]) for point in points]


def test_nothing_is_done_of_a_path_at_its_start() -> None:
    path = corner()

    done, ahead = drawn(path).lines(replace(task_on(path), distance_m=0.0))

    assert places(done) == [(0.0, 0.0), (0.0, 0.0)]
    assert places(ahead) == [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0)]


def test_a_path_is_parted_where_the_vehicle_is() -> None:
    path = corner()

    done, ahead = drawn(path).lines(replace(task_on(path), distance_m=25.0))

    assert places(done) == [(0.0, 0.0), (20.0, 0.0), (20.0, 5.0)]
    assert places(ahead) == [(20.0, 5.0), (20.0, 20.0)]


def test_nothing_is_ahead_at_its_end() -> None:
    path = corner()

    done, ahead = drawn(path).lines(replace(task_on(path), distance_m=40.0))

    assert places(done)[-1] == (20.0, 20.0)
    assert ahead == []


def test_what_comes_before_the_start_of_the_task_is_not_drawn() -> None:
    path = corner()

    done, ahead = drawn(path, start_index=20).lines(task_on(path, start_index=20))

    assert places(done)[0] == (10.0, 0.0)
    assert places(ahead)[-1] == (20.0, 20.0)


def test_the_last_two_waypoints_are_a_line() -> None:
    path = straight()

    assert len(drawn(path, start_index=path.count - 2).poses(HEADER)) == 2


def test_each_pose_faces_the_next_one() -> None:
    poses = drawn(corner()).poses(HEADER)

    turns = [each["pose"]["orientation"] for each in poses]
    yaws = [2 * atan2(turn["z"], turn["w"]) for turn in turns]
    assert yaws == pytest.approx([0.0, pi / 2, pi / 2])
    assert all(each["header"] == HEADER for each in poses)


def test_the_path_of_a_hundred_thousand_waypoints_is_drawn_with_few() -> None:
    angles = np.linspace(0.0, 40 * pi, 100_000)
    rows = [(a * cos(a), a * sin(a), 0.0) for a in (20 + angles).tolist()]
    path = Path(np.array(rows))
    found = DrawnPath(task_on(path), path)

    found.go_on()
    assert not found.is_done
    while not found.is_done:
        found.go_on()

    assert len(found.poses(HEADER)) <= MOST_POINTS
