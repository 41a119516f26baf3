"""Whatever happened: a replay of the record does the same, and finds what was changed in it.

`make soak` replays 1,000 runs, `make test` 50.
"""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from service.checkpoint import checkpoint_of, core_of_checkpoint
from service.replay import core_of_boot, replay
from tests.support.recorded_robot import BOOT, RecordedRobot, live, views_of

SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
RUNS = range(1_000 if SOAK else 50)


@pytest.fixture(scope="module", params=RUNS)
def seed(request: pytest.FixtureRequest) -> int:
    number: int = request.param
    return number


@pytest.fixture(scope="module")
def robot(seed: int) -> RecordedRobot:
    return live(seed)


def test_a_replay_does_what_was_done(robot: RecordedRobot) -> None:
    core = core_of_boot(BOOT)

    replayed = replay(core, robot.recorded())

    assert replayed.difference is None
    assert replayed.steps == len(robot.taken)
    assert views_of(core) == views_of(robot.onboard)


def test_a_replay_from_a_checkpoint_ends_the_same(seed: int, robot: RecordedRobot) -> None:
    steps = robot.recorded()
    middle = Random(seed).randrange(len(steps))
    core = core_of_boot(BOOT)
    replay(core, steps[:middle])

    copy = core_of_checkpoint(checkpoint_of(core, BOOT.version), BOOT.version)
    replayed = replay(copy, steps[middle:], middle + 1)

    assert replayed.difference is None
    assert views_of(copy) == views_of(robot.onboard)


def test_one_changed_decision_is_found_and_named(seed: int, robot: RecordedRobot) -> None:
    steps, rng = robot.recorded(), Random(seed)
    index = rng.choice([number for number, step in enumerate(steps) if step.events])
    events = list(steps[index].events)
    place = rng.randrange(len(events))
    left_out = events.pop(place)
    steps[index] = replace(steps[index], events=tuple(events))

    difference = replay(core_of_boot(BOOT), steps).difference

    assert difference is not None
    assert difference.step == index + 1
    assert difference.event == (events[place].id if events[place:] else left_out.id)
    assert left_out.event.words in difference.came


@pytest.mark.parametrize("hash_seed", ["1", "2"])
def test_a_replay_elsewhere_does_not_depend_on_the_order_of_sets(
    tmp_path: Path, hash_seed: str
) -> None:
    """Texts hash differently in each process, and so sets of names are walked in another order."""
    for number in range(len(RUNS) // 10):
        (tmp_path / f"{number}.jsonl").write_bytes(b"\n".join(live(number).record))

    env = {**os.environ, "PYTHONHASHSEED": hash_seed}
    command = [sys.executable, "-m", "tests.support.replay_elsewhere", str(tmp_path)]
    result = subprocess.run(command, env=env, capture_output=True, text=True, check=False)

    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
