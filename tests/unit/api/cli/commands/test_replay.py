import json
import signal
import socket
from pathlib import Path

import httpx
import pytest

from api.cli.command_line import main
from tests.support.process import replay_page
from tests.support.recorded_robot import RecordedRobot
from tests.support.stored_robot import held_on_its_way, store


@pytest.fixture(scope="module")
def robot() -> RecordedRobot:
    return held_on_its_way()


@pytest.fixture(scope="module")
def data(robot: RecordedRobot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of data of a robot."""
    folder = tmp_path_factory.mktemp("data") / "robot"
    store(folder, robot, checkpoints=(30,))
    return folder


def test_a_run_that_is_decided_the_same_is_said_to_be(
    data: Path, robot: RecordedRobot, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(data)]) == 0

    last = robot.events[-1].id
    assert capsys.readouterr().out == (
        f"run 1, from the start of the run: {len(robot.taken)} steps the same, up to event {last}\n"
    )


def test_a_piece_from_a_checkpoint_is_replayed(
    data: Path, robot: RecordedRobot, capsys: pytest.CaptureFixture[str]
) -> None:
    last = robot.events[-1].id

    assert main(["replay", str(data), "--from", str(last), "--until", str(last)]) == 0

    assert capsys.readouterr().out.startswith("run 1, from step 31: ")


def test_an_exported_piece_replays_and_a_changed_decision_in_it_is_named(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "bug"
    assert main(["export", str(data), "--to", "jsonl", "--out", str(out)]) == 0
    assert main(["replay", str(out)]) == 0
    capsys.readouterr()
    steps = out / "run-1-step-1" / "steps.jsonl"
    steps.write_text(steps.read_text().replace('"reason":"closed"', '"reason":"open"', 1))
    record = [json.loads(line) for line in steps.read_text().splitlines()]

    assert main(["replay", str(out)]) == 1

    number = next(n for n, step in enumerate(record, 1) if step["given"].get("reason") == "open")
    told = capsys.readouterr().out
    assert f"step {number} (hold_request): recorded was event " in told
    assert "hold gate requested: closed" in told.partition("but now came")[0]
    assert "hold gate requested: open" in told.partition("but now came")[2]


def test_an_exported_piece_is_replayed_as_a_whole(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "bug"
    main(["export", str(data), "--to", "jsonl", "--out", str(out)])

    assert main(["replay", str(out), "--from", "1"]) == 2

    assert "what was exported is replayed as a whole" in capsys.readouterr().err


def test_a_record_of_another_release_is_told(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "bug"
    main(["export", str(data), "--to", "jsonl", "--out", str(out)])
    run = out / "run-1-step-1" / "run.json"
    run.write_text(json.dumps(json.loads(run.read_text()) | {"version": "0.0.1"}))

    assert main(["replay", str(out)]) == 0

    assert "run 1 was recorded by release 0.0.1" in capsys.readouterr().err


@pytest.mark.parametrize("options", [[], ["--from", "5"]])
def test_a_folder_without_a_log_cannot_be_replayed(
    options: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(tmp_path), *options]) == 2

    assert "holds no log" in capsys.readouterr().err


def test_an_event_that_is_not_there_is_told(data: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["replay", str(data), "--from", "99999"]) == 2

    assert "event 99999 is not in the record" in capsys.readouterr().err


@pytest.mark.parametrize("speed", ["0.01", "1000", "fast"])
def test_a_page_is_shown_at_a_speed_that_can_be_followed(
    data: Path, speed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["replay", str(data), "--page", "--speed", speed])

    assert ended.value.code == 64
    assert "--speed" in capsys.readouterr().err


def test_a_page_of_a_folder_without_a_log_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(tmp_path), "--page"]) == 2

    assert "holds no log" in capsys.readouterr().err


def test_a_page_is_served_until_a_signal_ends_it(data: Path) -> None:
    with replay_page(data, "--speed", "100") as process:
        assert process.greeting.startswith("REPLAY of robot, from 2026-01-01 00:00:00 to ")
        answer = httpx.get(f"{process.url}/system_state")
        assert answer.status_code == 200
        process.send_signal(signal.SIGTERM)
        assert process.ended()[0] == 0


def test_a_port_that_is_taken_is_said_to_be(data: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])

        assert main(["replay", str(data), "--page", "--port", port]) == 2

    assert f"port {port} of 127.0.0.1 is in use" in capsys.readouterr().err


def test_what_was_exported_has_a_page_too(data: Path, tmp_path: Path) -> None:
    out = tmp_path / "bug"
    assert main(["export", str(data), "--to", "jsonl", "--out", str(out)]) == 0

    with replay_page(out) as process:
        assert httpx.get(f"{process.url}/replay").json()["robot"] == "bug"


def test_programs_get_an_object_for_each_piece(
    data: Path, robot: RecordedRobot, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(data), "--format", "json"]) == 0

    assert json.loads(capsys.readouterr().out) == {
        "run": 1,
        "first_step": None,
        "steps": len(robot.taken),
        "last_event": robot.events[-1].id,
        "difference": None,
    }
