"""What a reading costs that conditions name, and what those cost that do not name it."""

import gc
import time
from collections.abc import Sequence

import pytest

from domain.conditions.check import check
from domain.conditions.condition import Condition
from domain.conditions.tree import Topic, TopicKind
from domain.conditions.watched import WatchedConditions
from domain.health.signals import default_signals
from domain.robot_vocabulary import vocabulary_of
from tests.support.bench import quantiles, report
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import actuation_model

ROUNDS = 1_000
NAMING = 200
OTHERS = (100, 10_000)
BATTERY = Topic(TopicKind.SIGNAL, "battery_level")


@pytest.mark.bench
def test_a_reading_that_conditions_name_and_those_that_do_not_name_it() -> None:
    naming = [
        Condition(f"battery_level >= {number / NAMING:.3f} and drive_base.state == unconfigured")
        for number in range(NAMING)
    ]
    rows = {f"{NAMING} name it": _measure(naming, 0)}
    for others in OTHERS:
        rows[f"8 name it, {others:,} do not"] = _measure(naming[:8], others)
    few, many = (rows[f"8 name it, {others:,} do not"]["p50_ms"] for others in OTHERS)
    rows[f"{NAMING} are all explained"] = _explain(naming)
    rows["one is read and checked"] = _read_and_check(naming)
    report(
        "conditions",
        "Conditions",
        "A reading arrives. The conditions that name its signal are evaluated, and those whose "
        f"value changed are explained. {ROUNDS} readings that go from 1 to 0 and back by steps of "
        "0.01, with the facts of the robot of D4.8. Beside it, what it takes to explain all of "
        "them, which nothing needs for a reading, and to read and check one.",
        rows,
        asked=f"a median below 0.3 ms for {NAMING}, and a ratio of {OTHERS[1]:,} to {OTHERS[0]} "
        "others of at most 1.2.",
        notes=[f"The ratio is {many / few:.2f}."],
    )


def _measure(naming: Sequence[Condition], others: int) -> dict[str, float]:
    """Let the battery run down and be charged, so that some conditions change each time."""
    robot = CoreRobot(actuation_model())
    robot.read(**GOOD)
    watched = WatchedConditions(robot.core.facts)
    watched.watch([Condition(f"temperature < {number}") for number in range(others)], robot.now)
    watched.watch(naming, robot.now)
    took, changes = [], 0
    gc.collect()
    gc.disable()
    for number in range(ROUNDS):
        robot.read(battery_level=abs(number % 200 - 100) / 100)
        begin = time.perf_counter()
        watched.touch(BATTERY)
        changed = watched.renew(robot.now)
        for condition in changed:
            watched.explain(condition)
        took.append(time.perf_counter() - begin)
        changes += len(changed)
    gc.enable()
    return {**quantiles(took), "changed": round(changes / ROUNDS)}


def _explain(naming: Sequence[Condition]) -> dict[str, float]:
    robot = CoreRobot(actuation_model())
    robot.read(**{**GOOD, "battery_level": 0.0})
    watched = WatchedConditions(robot.core.facts)
    watched.watch(naming, robot.now)
    took = []
    for _ in range(ROUNDS // 10):
        begin = time.perf_counter()
        for condition in naming:
            watched.explain(condition)
        took.append(time.perf_counter() - begin)
    return quantiles(took)


def _read_and_check(naming: Sequence[Condition]) -> dict[str, float]:
    vocabulary = vocabulary_of(actuation_model(), default_signals(), is_complete=True)
    took = []
    for condition in naming:
        begin = time.perf_counter()
        check(Condition.parse(condition.text), vocabulary)
        took.append(time.perf_counter() - begin)
    return quantiles(took)
