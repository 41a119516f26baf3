"""The runs of a profile: in which order, and how long they will take."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from random import Random
from typing import TypeAlias

from api.profiling.robot import Robot
from api.profiling.run import measure_run
from api.profiling.run_file import Run
from api.profiling.triggers import Trigger

_OVERHEAD_S = 1.7
"""What a run takes beside the persistence, as long as none has ended."""


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a profile is."""

    done: int
    total: int
    trigger: str
    """The error of the run that begins."""
    left_s: float
    """Estimated time to the end of the last run."""


Tell: TypeAlias = Callable[[Progress], None]
Keep: TypeAlias = Callable[[Run], None]


async def measure_runs(
    robot: Robot, triggers: Sequence[Trigger], runs: int, random: Random, keep: Keep, tell: Tell
) -> None:
    """Measure each trigger a number of times.

    The triggers take turns, so that a profile that is ended early has as many runs of each, and
    other load of the machine meets all of them.

    Args:
        robot: The robot.
        triggers: What stops it.
        runs: How often each does.
        random: Decides the phases of the readings.
        keep: Called with each run when it has ended.
        tell: Called before each run.

    Raises:
        LostServiceError: The service is gone; what was measured is kept.
    """
    plan = list(product(range(1, runs + 1), triggers))
    waits_s = [trigger.persistence_s(robot.settings) for _, trigger in plan]
    begin = robot.now()
    for done, (number, trigger) in enumerate(plan):
        took_s = robot.now() - begin - sum(waits_s[:done])
        each_s = took_s / done if done else _OVERHEAD_S
        left_s = sum(waits_s[done:]) + each_s * (len(plan) - done)
        tell(Progress(done, len(plan), trigger.error, left_s))
        keep(await measure_run(robot, trigger, number, random))
