"""What a real service recorded is decided the same again, also while it runs and after kills."""

from pathlib import Path

import httpx
import pytest

from tests.support.kill_rounds import kill_rounds
from tests.support.process import run, service


@pytest.mark.timeout(180)
async def test_all_runs_replay_though_each_was_killed(tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    await kill_rounds(folder, 3, seed=5)

    code, told, complaints = run("replay", str(folder))

    assert (code, complaints) == (0, "")
    # Without the load, one more run looks at what is there.
    assert [line.partition(",")[0] for line in told.splitlines()][:3] == ["run 1", "run 2", "run 3"]


def test_a_piece_is_cut_out_while_the_service_runs(tmp_path: Path) -> None:
    folder, piece = tmp_path / "robot", tmp_path / "bug"
    with service("--data", str(folder)) as process, httpx.Client(base_url=process.url) as http:
        engaged = http.put("/emergency_stop", json={"engaged": True, "reason": "smoke"})
        assert engaged.headers["Pilothouse-Durable"] == "true"

        assert run("export", str(folder), "--to", "jsonl", "--out", str(piece))[0] == 0

    code, told, _ = run("replay", str(piece))
    assert code == 0
    assert told.startswith("run 1, from the start of the run: ")
    (events,) = piece.glob("*/events.jsonl")
    assert "emergency stop engaged: smoke" in events.read_text()
