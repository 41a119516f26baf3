"""How long one report takes to reach every system that its node belongs to.

Beside it the same on a robot all of whose systems deviate, where an inference that walks the tree
anew is many times slower.
"""

import time
from statistics import median

import pytest

from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from domain.parts.system_model import SmhModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from tests.support.bench import report
from tests.support.big_model import FAST, PARAMETERS, SLOW, big_model

ROUNDS = 500
BOUNDS_MS = {100: 0.1, 1_000: 0.2, 10_000: 0.3}
"""What was asked of the median."""
CPP = (
    "The C++ of micro-ROS system_modes, measured on another machine: 0.05 to 0.4 ms, 0.85 to 47 ms "
    "and 28 to 2,200 ms."
)


@pytest.mark.bench
def test_a_report_and_the_inference_of_all_ancestors() -> None:
    rows = {}
    bounds = ", ".join(f"{bound:g}" for bound in BOUNDS_MS.values())
    for nodes in BOUNDS_MS:
        model = big_model(nodes)
        in_target, deviating = _robot(model, FAST), _robot(model, SLOW)
        rows[f"{nodes:,} nodes, in target"] = _measure(model, in_target, FAST, SLOW)
        rows[f"{nodes:,} nodes, all deviate"] = _measure(model, deviating, SLOW, DEFAULT_MODE)
    report(
        "inference",
        "Inference",
        "A node reports another mode, and the states of all systems above it are inferred. "
        f"{2 * ROUNDS} reports, one node after another, in a tree with ten parts per system; once "
        "on a robot at its target, once on a robot in which all systems deviate.",
        rows,
        asked=f"a median of at most {bounds} ms at 100, 1,000 and 10,000 nodes.",
        notes=[CPP],
    )


def _robot(model: SmhModel, mode: ModeName) -> ModeInference:
    """Return a robot that should be in FAST, all of whose nodes are in `mode`."""
    inference = ModeInference(model)
    inference.set_targets({part: StateAndMode(LifecycleState.ACTIVE, FAST) for part in model.parts})
    for node in model.nodes:
        inference.report(_report(node, mode))
    root = model.parts[0]
    assert inference.converged(root) is (mode == FAST)
    return inference


def _measure(
    model: SmhModel, inference: ModeInference, mode: ModeName, other: ModeName
) -> dict[str, float]:
    """Move one node after the other to another mode and back."""
    took = []
    nodes = list(model.nodes)
    for number in range(ROUNDS):
        node = nodes[number * 37 % len(nodes)]
        for each in (other, mode):
            given = _report(node, each)
            begin = time.perf_counter()
            inference.report(given)
            took.append(time.perf_counter() - begin)
    ordered = sorted(took)
    return {
        "ancestors": len(model.ancestors[nodes[0]]),
        "p50_ms": round(1000 * median(ordered), 4),
        "p99_ms": round(1000 * ordered[round(0.99 * (len(ordered) - 1))], 4),
    }


def _report(node: PartName, mode: ModeName) -> NodeReport:
    return NodeReport(node, LifecycleState.ACTIVE, parameters=PARAMETERS[mode], reachable=True)
