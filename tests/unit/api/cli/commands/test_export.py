import json
import sys
from pathlib import Path

import pytest

from api.cli.command_line import main
from api.cli.commands import export as command
from tests.support.recorded_robot import RecordedRobot
from tests.support.stored_robot import held_on_its_way, store


@pytest.fixture(scope="module")
def robot() -> RecordedRobot:
    return held_on_its_way()


@pytest.fixture(scope="module")
def data(robot: RecordedRobot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data") / "robot"
    store(folder, robot, checkpoints=(30,))
    return folder


def export(data: Path, out: Path, *options: str) -> int:
    return main(["export", str(data), "--to", "jsonl", "--out", str(out), *options])


def test_the_folder_has_what_a_replay_and_a_person_need(
    data: Path, robot: RecordedRobot, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "bug"

    assert export(data, out) == 0

    assert capsys.readouterr().out == f"{out}: {len(robot.taken)} steps\n"
    (piece,) = out.iterdir()
    assert {file.name for file in piece.iterdir()} == {"run.json", "steps.jsonl", "events.jsonl"}
    events = (piece / "events.jsonl").read_text().splitlines()
    assert [json.loads(line)["id"] for line in events] == [event.id for event in robot.events]


def test_a_piece_is_cut_out(data: Path, robot: RecordedRobot, tmp_path: Path) -> None:
    last = str(robot.events[-1].id)

    assert export(data, tmp_path / "bug", "--from", last, "--until", last) == 0

    (piece,) = (tmp_path / "bug").iterdir()
    assert piece.name == "run-1-step-31"
    assert (piece / "checkpoint").read_bytes().startswith(b"pilothouse checkpoint ")


def test_nothing_that_is_there_is_overwritten(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert export(data, tmp_path) == 2

    assert capsys.readouterr().err.endswith("exists already\n")


def test_a_folder_without_a_log_cannot_be_exported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert export(tmp_path / "missing", tmp_path / "bug") == 2

    assert "holds no log" in capsys.readouterr().err


def test_a_place_that_cannot_be_written_is_told(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "file"
    file.write_text("")

    assert export(data, file / "bug") == 2

    assert "Not a directory" in capsys.readouterr().err


def export_mcap(data: Path, out: Path, *options: str) -> int:
    return main(["export", str(data), "--to", "mcap", "--out", str(out), *options])


def test_a_file_for_viewers_is_written_and_counted(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run.mcap"

    assert export_mcap(data, out) == 0

    assert out.read_bytes().startswith(b"\x89MCAP0\r\n")
    printed = capsys.readouterr()
    assert printed.out.startswith(f"{out}: ")
    assert printed.out.endswith(" messages\n")
    assert printed.err == ""
    assert [path.name for path in tmp_path.iterdir()] == ["run.mcap"]


def test_a_long_export_tells_how_far_it_is(
    data: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(command, "_PROGRESS_EVERY_S", 0.0)

    assert export_mcap(data, tmp_path / "run.mcap") == 0

    assert "pilothouse: at 2026-01-01 00:00:0" in capsys.readouterr().err


def test_without_mcap_it_is_said_how_to_get_it(
    data: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "mcap", None)

    assert export_mcap(data, tmp_path / "run.mcap") == 2

    assert "install pilothouse[recording]" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_there_is_not_overwritten(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run.mcap"
    out.write_text("mine")

    assert export_mcap(data, out) == 2

    assert out.read_text() == "mine"
    assert "exists already" in capsys.readouterr().err


def test_programs_are_told_in_json(
    data: Path, robot: RecordedRobot, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "bug"

    assert export(data, out, "--format", "json") == 0

    told = json.loads(capsys.readouterr().out)
    assert told == {"path": str(out), "steps": len(robot.taken)}
