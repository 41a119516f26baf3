from pathlib import Path

import pytest

from domain.inputs import HoldRequest, ReleaseRequest
from service.recorded_pieces import NothingRecordedError, Piece, pieces_of
from service.replay import replay_piece
from service.storage.sqlite.recorded_log import RecordedHole, RecordedLog
from tests.support.recorded_robot import RecordedRobot
from tests.support.stored_robot import boot_of, held_on_its_way, store

VERSION = boot_of(1).version
CHECKPOINTS = (20, 60)


@pytest.fixture(scope="module")
def robot() -> RecordedRobot:
    return held_on_its_way()


@pytest.fixture(scope="module")
def folder(robot: RecordedRobot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the data of a robot whose service ran twice, with checkpoints in the first run."""
    folder = tmp_path_factory.mktemp("data") / "robot"
    again = RecordedRobot(restored=robot.kept())
    again.advance(1)
    store(folder, robot, again, checkpoints=CHECKPOINTS)
    return folder


def event_of(robot: RecordedRobot, kind: type) -> int:
    """Return the id of the first event that an input led to."""
    step = next(step for step in robot.taken if isinstance(step.given, kind))
    return step.outputs.events[0].id


def replayed(pieces: list[Piece]) -> list[tuple[int, int, int]]:
    """Replay pieces; return the run of each, its first step and how many were the same."""
    told = []
    for piece in pieces:
        result = replay_piece(piece, VERSION)
        assert result.difference is None
        told.append((piece.run, piece.first, result.steps))
    return told


def test_without_limits_each_run_is_replayed_from_its_start(
    folder: Path, robot: RecordedRobot
) -> None:
    pieces = list(pieces_of(RecordedLog(folder), VERSION, None, None))

    assert [piece.state for piece in pieces] == [None, None]
    (first_run, second_run) = replayed(pieces)
    assert first_run == (1, 1, len(robot.taken))
    assert second_run[:2] == (2, len(robot.taken) + 1)


def test_a_piece_begins_with_the_last_checkpoint_before_the_event(
    folder: Path, robot: RecordedRobot
) -> None:
    released = event_of(robot, ReleaseRequest)

    pieces = list(pieces_of(RecordedLog(folder), VERSION, released, released))

    assert [piece.first for piece in pieces] == [CHECKPOINTS[1] + 1]
    *_, last = pieces[0].steps
    assert isinstance(last.given, ReleaseRequest)


def test_a_piece_ends_with_the_last_event(folder: Path, robot: RecordedRobot) -> None:
    held = event_of(robot, HoldRequest)

    (told,) = replayed(list(pieces_of(RecordedLog(folder), VERSION, None, held)))

    before = [isinstance(step.given, HoldRequest) for step in robot.taken].index(True)
    assert told == (1, 1, before + 1)


def test_a_checkpoint_of_another_release_is_not_used(folder: Path, robot: RecordedRobot) -> None:
    released = event_of(robot, ReleaseRequest)

    (piece,) = pieces_of(RecordedLog(folder), "0.0.1", released, released)

    assert (piece.first, piece.state) == (1, None)


def test_after_a_hole_the_next_piece_begins_with_a_checkpoint(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hole = RecordedHole(1, CHECKPOINTS[0] + 10, 3, 0, 0, 0, "disk full")
    monkeypatch.setattr(RecordedLog, "holes", lambda log: [hole])

    pieces = list(pieces_of(RecordedLog(folder), VERSION, None, None))

    assert [piece.first for piece in pieces if piece.run == 1] == [1, CHECKPOINTS[1] + 1]
    assert replayed(pieces)[0] == (1, 1, CHECKPOINTS[0] + 10)


def test_an_event_that_is_not_in_the_log_is_told(folder: Path) -> None:
    with pytest.raises(NothingRecordedError, match="event 99999 is not in the record"):
        list(pieces_of(RecordedLog(folder), VERSION, 99_999, None))


def test_a_log_whose_start_is_gone_and_without_a_checkpoint_is_told(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = RecordedLog.lines
    monkeypatch.setattr(
        RecordedLog, "lines", lambda log, run, after=0: lines(log, run, max(after, 5))
    )
    monkeypatch.setattr(RecordedLog, "checkpoints", lambda log: [])

    with pytest.raises(NothingRecordedError, match="neither the start of the run nor a checkpoint"):
        list(pieces_of(RecordedLog(folder), VERSION, None, 3))
