from pathlib import Path

import pytest

from domain.snapshot import TaskPhase
from service.files.driving_block import StartTaskBlock
from service.files.text_file import UnreadableFileError
from service.start_task import StartTaskError, submit_start_task
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock

LINE = "0,0,0\n5,0,0\n10,0,0\n"


def robot_file(folder: Path, track: str = LINE) -> Path:
    (folder / "tracks").mkdir()
    (folder / "tracks" / "line.csv").write_text(track)
    return folder / "robot.yaml"


def test_a_start_task_is_taken_and_waits_until_the_robot_knows_itself(tmp_path: Path) -> None:
    supervisor = make_supervisor()
    submit_start_task(supervisor, StartTaskBlock(file="tracks/line.csv"), robot_file(tmp_path))
    task = supervisor.core.driving.current_task

    assert task is not None
    assert task.status is TaskPhase.PAUSING


async def test_it_is_driven_once_nothing_holds_it(tmp_path: Path) -> None:
    clock = ManualClock()
    supervisor = make_supervisor(clock)
    submit_start_task(supervisor, StartTaskBlock(file="tracks/line.csv"), robot_file(tmp_path))
    async with running(supervisor):
        await clock.advance(1)
        task = supervisor.core.driving.current_task

    assert task is not None
    assert task.status is TaskPhase.RUNNING
    assert task.distance_m > 0.1


def test_a_file_that_is_not_there_is_told_by_its_name(tmp_path: Path) -> None:
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
    tmp_path: Path, track: str, block: StartTaskBlock, words: str
) -> None:
    with pytest.raises(StartTaskError, match=words):
        submit_start_task(make_supervisor(), block, robot_file(tmp_path, track))
