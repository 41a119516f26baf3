"""A week of faults, requests and drives: nothing that must hold breaks, and nothing grows.

`make soak` lives through a week twice, with restarts of the service and without; `make test`
through half an hour of each, in which more happens per minute.
"""

import os
from types import SimpleNamespace

import pytest

from domain.timebase import seconds
from tests.support.happenings import calm_down, let_happen
from tests.support.long_run import LongRun
from tests.support.object_graph import growth, sizes_of

SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
DAYS = 7
DAY_S = 24 * 3600.0 if SOAK else 1800.0 / DAYS
PAUSE_S = 4.0 if SOAK else 1.0
"""How long nothing happens, on the average."""
LIVES_S = (DAY_S / 24, DAY_S / 6)
"""How long the service runs before it is ended, from and to."""
GROWTH = 0.05
PLACES_SHOWN = 5


def measured(robot: LongRun, *, restarts: bool) -> dict[str, int]:
    """Return the size of all that the core and storage hold, when nothing goes on."""
    calm_down(robot)
    if restarts:
        # Each day ends at another age of the core, and so with as many ended changes.
        robot.restart(1.0, is_killed=True)
        calm_down(robot)
    kept: dict[str, list[bytes]] = {}
    for (kind, _), text in robot.kept.items():
        kept.setdefault(kind.__name__, []).append(text)
    return {**sizes_of(robot.onboard), **sizes_of(SimpleNamespace(**kept))}


def live(robot: LongRun, *, restarts: bool) -> None:
    """Let a day pass, with a restart every few hours."""
    midnight = robot.now + seconds(DAY_S)
    while restarts and robot.now + seconds(LIVES_S[1]) < midnight:
        let_happen(robot, robot.random, robot.random.uniform(*LIVES_S), PAUSE_S)
        robot.restart(robot.random.uniform(0.0, 30.0), is_killed=robot.random.random() < 0.5)
    let_happen(robot, robot.random, (midnight - robot.now) / seconds(1.0), PAUSE_S)


@pytest.mark.timeout(0 if SOAK else 60)
@pytest.mark.parametrize("restarts", [True, False], ids=["restarts", "one run"])
def test_a_week_breaks_nothing_and_nothing_grows(*, restarts: bool) -> None:
    robot = LongRun(seed=13)
    days: list[dict[str, int]] = []
    for _ in range(DAYS):
        live(robot, restarts=restarts)
        days.append(measured(robot, restarts=restarts))

    grown = growth(days[0], days[-1])
    worst = [f"{share:+.1%} {place}" for place, share in grown.items()][:PLACES_SHOWN]
    print(
        f"\n{robot.inputs} inputs, {robot.last_event} events, {robot.boot} boots", *worst, sep="\n"
    )
    # In an hour not everything is as full as it may become.
    assert not SOAK or max(grown.values(), default=0.0) <= GROWTH, worst
