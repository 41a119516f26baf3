from pathlib import Path as FilePath

import numpy as np
import pytest
from pydantic import ValidationError

from domain.inputs import TaskRequest
from domain.paths.path import Path
from domain.snapshot import TaskPhase
from service.files.driving_block import StartTaskBlock
from service.files.text_file import UnreadableFileError
from service.start_task import StartTaskError, submit_start_task
from service.storage.journal import Boot
from service.storage.memory import MemoryJournal, MemoryStore
from service.supervisor import Supervisor
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock

LINE = "0,0,0\n5,0,0\n10,0,0\n"


def robot_file(folder: FilePath, track: str = LINE) -> FilePath:
    (folder / "tracks").mkdir()
    (folder / "tracks" / "line.csv").write_text(track)
    return folder / "robot.yaml"


def test_a_start_task_is_taken_and_waits_until_the_robot_knows_itself(tmp_path: FilePath) -> None:
    supervisor = make_supervisor()
    submit_start_task(supervisor, StartTaskBlock(file="tracks/line.csv"), robot_file(tmp_path))
    task = supervisor.core.driving.current_task

    assert task is not None
    assert task.status is TaskPhase.PAUSING


def test_columns_and_headings_of_its_file_may_be_told(tmp_path: FilePath) -> None:
    supervisor = make_supervisor()
    block = StartTaskBlock(file="tracks/line.csv", columns="s,x,y,yaw", heading="compass")
    submit_start_task(supervisor, block, robot_file(tmp_path, "0 0 0 90\n5 5 0 90\n9 9 0 90\n"))
    task = supervisor.core.driving.current_task

    assert task is not None
    waypoints = supervisor.core.driving.path_of(task.id).waypoints
    assert waypoints == pytest.approx(np.array([[0, 0, 0], [5, 0, 0], [9, 0, 0]]))


def test_columns_without_x_are_refused() -> None:
    with pytest.raises(ValidationError, match="no column is named x"):
        StartTaskBlock(file="a.csv", columns="s,y")


async def test_it_is_driven_once_nothing_holds_it(tmp_path: FilePath) -> None:
    clock = ManualClock()
    supervisor = make_supervisor(clock)
    submit_start_task(supervisor, StartTaskBlock(file="tracks/line.csv"), robot_file(tmp_path))
    async with running(supervisor):
        await clock.advance(1)
        task = supervisor.core.driving.current_task

    assert task is not None
    assert task.status is TaskPhase.RUNNING
    assert task.distance_m > 0.1


def test_a_file_that_is_not_there_is_told_by_its_name(tmp_path: FilePath) -> None:
    block = StartTaskBlock(file="tracks/other.csv")
    with pytest.raises(UnreadableFileError, match=r"other\.csv"):
        submit_start_task(make_supervisor(), block, robot_file(tmp_path))


@pytest.mark.parametrize(
    ("track", "block", "words"),
    [
        ("x,y,yaw\n", StartTaskBlock(file="tracks/line.csv"), "line 1"),
        (LINE, StartTaskBlock(file="tracks/line.csv", speed_mps=99.0), "99 m/s"),
    ],
)
def test_what_cannot_be_driven_is_told_with_its_reason(
    tmp_path: FilePath, track: str, block: StartTaskBlock, words: str
) -> None:
    with pytest.raises(StartTaskError, match=words):
        submit_start_task(make_supervisor(), block, robot_file(tmp_path, track))


def second_run(task: bool) -> Supervisor:
    """Return a supervisor whose earlier run had a task that did not end, or none."""
    clock, store = ManualClock(), MemoryStore()
    boot = Boot("first", "1", clock.now(), clock.wall_time(clock.now()), "", "")
    first = make_supervisor(clock, journal=MemoryJournal(boot, clock, store))
    if task:
        first.submit(
            TaskRequest(Path(np.array([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]])), 0, "stanley", 1.0)
        )
    return make_supervisor(clock, journal=MemoryJournal(boot, clock, store))


async def test_after_a_restart_it_waits_for_a_person(tmp_path: FilePath) -> None:
    supervisor = second_run(task=False)
    submit_start_task(supervisor, StartTaskBlock(file="tracks/line.csv"), robot_file(tmp_path))

    assert "start_task" in supervisor.core.driving.holds
    assert supervisor.core.driving.current_task is not None


async def test_it_does_not_replace_a_task_that_has_not_ended(
    tmp_path: FilePath, caplog: pytest.LogCaptureFixture
) -> None:
    supervisor = second_run(task=True)
    submit_start_task(supervisor, StartTaskBlock(file="tracks/line.csv"), robot_file(tmp_path))
    task = supervisor.core.driving.current_task

    assert task is not None
    assert (task.controller, len(list(supervisor.core.driving.tasks()))) == ("stanley", 1)
    assert "restart" in supervisor.core.driving.holds
    assert "left out" in caplog.text
