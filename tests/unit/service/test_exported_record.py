import json
from pathlib import Path

import pytest

from service.codec.errors import CodecError
from service.exported_record import InvalidExportError, is_export, read_pieces, write_piece
from service.recorded_pieces import Piece
from service.replay import replay_piece
from tests.support.recorded_robot import RecordedRobot
from tests.support.stored_robot import boot_of, held_on_its_way

BOOT = boot_of(1)


@pytest.fixture(scope="module")
def robot() -> RecordedRobot:
    return held_on_its_way()


@pytest.fixture
def folder(robot: RecordedRobot, tmp_path: Path) -> Path:
    """Return an exported run."""
    piece = Piece(4, BOOT, None, 101, iter(robot.recorded()))
    assert write_piece(piece, tmp_path / "out") == len(robot.taken)
    return tmp_path / "out"


def test_what_was_exported_replays_elsewhere(folder: Path, robot: RecordedRobot) -> None:
    assert is_export(folder)
    (piece,) = read_pieces(folder)

    assert (piece.run, piece.boot, piece.state, piece.first) == (4, BOOT, None, 101)
    replayed = replay_piece(piece, BOOT.version)
    assert (replayed.difference, replayed.steps) == (None, len(robot.taken))


def test_events_are_there_for_people(folder: Path, robot: RecordedRobot) -> None:
    lines = (folder / "run-4-step-101" / "events.jsonl").read_text().splitlines()

    told = [json.loads(line) for line in lines]
    assert [event["id"] for event in told] == [event.id for event in robot.events]
    held = next(event for event in told if event["kind"] == "hold.set")
    assert held["words"] == "hold gate set: closed"
    assert held["at"].startswith("2026-01-01T00:00:0")


def test_a_checkpoint_goes_along(tmp_path: Path) -> None:
    write_piece(Piece(1, BOOT, b"state", 7, iter(())), tmp_path)

    (piece,) = read_pieces(tmp_path)

    assert piece.state == b"state"


def test_pieces_come_in_the_order_of_their_steps(tmp_path: Path) -> None:
    for run, first in ((10, 900), (9, 1000), (9, 99)):
        write_piece(Piece(run, BOOT, None, first, iter(())), tmp_path)

    assert [(p.run, p.first) for p in read_pieces(tmp_path)] == [(9, 99), (9, 1000), (10, 900)]


def test_nothing_is_overwritten(folder: Path) -> None:
    with pytest.raises(FileExistsError):
        write_piece(Piece(4, BOOT, None, 101, iter(())), folder)


def test_another_folder_is_no_export(tmp_path: Path) -> None:
    assert not is_export(tmp_path)
    assert not is_export(tmp_path / "missing")


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"codec": "one"}'])
def test_a_broken_description_of_a_run_is_told(folder: Path, text: str) -> None:
    (folder / "run-4-step-101" / "run.json").write_text(text)

    with pytest.raises(InvalidExportError, match=r"run\.json"):
        list(read_pieces(folder))


def test_steps_of_a_newer_release_are_not_guessed(folder: Path) -> None:
    file = folder / "run-4-step-101" / "run.json"
    file.write_text(file.read_text().replace('"codec": 1', '"codec": 2'))

    with pytest.raises(CodecError, match="records of version 2"):
        list(read_pieces(folder))


def test_a_broken_step_is_told(folder: Path) -> None:
    (folder / "run-4-step-101" / "steps.jsonl").write_text('{"is": "time_passed"}\n')
    (piece,) = read_pieces(folder)

    with pytest.raises(CodecError):
        list(piece.steps)
