"""What it takes to find the minimal cut sets of a robot."""

import random
import time

import pytest

from domain.analysis.cut_sets import Event, Gate, minimal_cut_sets
from domain.analysis.fault_trees import error_graph, fault_trees
from service.files.model_file import read_model
from tests.support.bench import quantiles, report
from tests.support.documents import read_blocks
from tests.support.shared import PROJECT

HOW_TO = PROJECT / "docs" / "how-to" / "find-single-points-of-failure.md"
ROUNDS = 20
ROBOTS = 30
ERRORS = 200
BASIC = 80


@pytest.mark.bench
def test_cut_sets_of_small_and_large_robots() -> None:
    rows = {"the example of the how-to, with reading it": _example()}
    rows |= {f"{ERRORS} errors, up to {fan} causes each": _large(fan) for fan in (3, 8, 20)}
    rows["ten channels of ten causes each, in part"] = _redundant()
    report(
        "analysis",
        "Fault trees",
        f"The minimal cut sets of all errors of a robot: of an example, {ROUNDS} times; of "
        f"{ROBOTS} random graphs of {ERRORS} errors each, {ERRORS - BASIC} of which follow from "
        "any or from all of some others; and of an error with 10^10 cut sets.",
        rows,
        asked="below 100 ms for an example, and below 5 s for 200 errors.",
        notes=["`in_part` counts errors with too many cut sets to list all of them."],
    )


def _example() -> dict[str, float]:
    text = next(block.text for block in read_blocks(HOW_TO) if "file" in block.marks)
    took = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        fault_trees(error_graph(read_model(text).model, {}))
        took.append(time.perf_counter() - begin)
    return {**quantiles(took), "in_part": 0}


def _large(fan: int) -> dict[str, float]:
    took, in_part = [], 0
    for seed in range(ROBOTS):
        chance = random.Random(seed)
        gates = {
            Event(number): Gate(
                tuple(
                    Event(each)
                    for each in chance.sample(
                        range(max(0, number - BASIC), number), chance.randint(1, fan)
                    )
                ),
                chance.random() < 0.5,
            )
            for number in range(BASIC, ERRORS)
        }
        begin = time.perf_counter()
        found = minimal_cut_sets(gates, gates)
        took.append(time.perf_counter() - begin)
        in_part += sum(each.order is not None for each in found.values())
    return {**quantiles(took), "in_part": in_part}


def _redundant() -> dict[str, float]:
    gates = {
        Event(100 + channel): Gate(tuple(Event(10 * channel + n) for n in range(10)))
        for channel in range(10)
    }
    top = Event(110)
    gates[top] = Gate(tuple(Event(100 + channel) for channel in range(10)), needs_all=True)
    took = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        minimal_cut_sets(gates, [top])
        took.append(time.perf_counter() - begin)
    return {**quantiles(took), "in_part": 1}
