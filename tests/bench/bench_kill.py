"""Two hundred times `kill -9` at a random moment under load."""

from pathlib import Path

import pytest

from tests.support.bench import quantiles, report
from tests.support.kill_rounds import kill_rounds

pytestmark = pytest.mark.bench

ROUNDS = 200


async def test_two_hundred_kills(tmp_path: Path) -> None:
    expected, starts = await kill_rounds(tmp_path / "robot", ROUNDS, seed=13)
    report(
        "kill",
        "Killed under load",
        "A service of the example robot is killed with SIGKILL, 0.02 to 1 s after six clients "
        "began to set and release holds and the emergency stop, submit tasks and change modes. "
        "After each start all that was answered as durable is compared with what is there, before "
        "anybody asks for anything. `start` is up to the first 200 of /readyz.",
        {
            "kill -9": {
                "rounds": ROUNDS,
                "answered": expected.answered,
                "tasks": len(expected.tasks),
                "events": len(expected.events),
                "lost": 0,
                "start_p50_ms": quantiles(starts)["p50_ms"],
                "start_max_ms": quantiles(starts)["max_ms"],
            }
        },
        asked="nothing lost, at most 0.5 s of progress; no round needs a hand.",
    )
