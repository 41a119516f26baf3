"""What of a record can be shown, and from when to when."""

from pathlib import Path

import pytest

from api.replaying.recording import recording_of
from domain.errors import InvalidValueError
from domain.timebase import seconds
from service.exported_record import write_piece
from service.recorded_pieces import NothingRecordedError, offset_of, pieces_of
from service.storage.errors import UnusableFolderError
from service.storage.sqlite.recorded_log import RecordedLog
from tests.support.recorded_robot import RecordedRobot
from tests.support.stored_robot import boot_of, held_on_its_way, store

VERSION = boot_of(1).version
OFFSET = offset_of(boot_of(1))


@pytest.fixture(scope="module")
def robot() -> RecordedRobot:
    return held_on_its_way()


@pytest.fixture(scope="module")
def folder(robot: RecordedRobot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data") / "robot"
    again = RecordedRobot(boot_of(2), robot.kept())
    again.advance(1)
    store(folder, robot, again, checkpoints=(20, 60))
    return folder


def test_it_goes_from_the_first_run_to_the_end_of_the_last(
    folder: Path, robot: RecordedRobot
) -> None:
    found = recording_of(folder, VERSION, None, None)

    assert found.begin == boot_of(1).started_at + OFFSET
    assert found.end >= boot_of(2).started_at + offset_of(boot_of(2)) + seconds(1)


def test_the_pieces_begin_with_the_last_checkpoint_before_and_go_on(
    folder: Path, robot: RecordedRobot
) -> None:
    found = recording_of(folder, VERSION, None, None)

    pieces = list(found.pieces_from(robot.taken[65].at + OFFSET))

    assert [(piece.run, piece.first) for piece in pieces] == [(1, 61), (2, len(robot.taken) + 1)]


def test_between_two_runs_the_second_is_next(folder: Path) -> None:
    found = recording_of(folder, VERSION, None, None)

    pieces = list(found.pieces_from(found.begin + seconds(1_800)))

    assert [piece.run for piece in pieces] == [2]


def test_what_was_exported_is_shown_as_a_whole(folder: Path, tmp_path: Path) -> None:
    for piece in pieces_of(RecordedLog(folder), VERSION, None, None):
        write_piece(piece, tmp_path / "bug")

    found = recording_of(tmp_path / "bug", VERSION, None, None)

    assert found.robot == "bug"
    assert found.begin == boot_of(1).started_at + OFFSET
    assert [piece.run for piece in found.pieces_from(found.end)] == [1, 2]
    with pytest.raises(InvalidValueError, match="as a whole"):
        recording_of(tmp_path / "bug", VERSION, 1, None)


def test_a_folder_with_nothing_in_it_has_no_recording(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(UnusableFolderError):
        recording_of(tmp_path, VERSION, None, None)
    with pytest.raises(NothingRecordedError, match="event 99999 is not in the record"):
        recording_of(folder, VERSION, 99_999, None)
