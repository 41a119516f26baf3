"""The vectors of smart_polaris through `POST /simulations`, all groups of them.

What a vector expects is looked up in the samples. A vector that scripts the controller is played on
the supervision alone (tests/conformance/test_planner_vectors.py): here the real one drives.
"""

import math
from collections.abc import Iterator, Mapping
from http import HTTPStatus
from typing import Any

import pytest

from service.files.csv_table import InvalidWaypointsError
from service.files.waypoint_file import read_waypoints_csv
from tests.conformance.test_polaris_vectors import OVERRULED, expectation
from tests.support.blocking_service import BlockingService
from tests.support.planner_vectors import Seen, looks_of, wrong_keys
from tests.support.polaris import BITS, Vector, sends_of
from tests.support.shared import json_cases, shared_folder

VECTORS = json_cases("conformance/polaris/vectors", "*.json", "vectors")

PERIOD_MS = 10
"""Of the samples: every time that a vector looks at is a multiple of it."""


def waypoints(file: str) -> list[dict[str, float]] | None:
    """Return a fixture as it is sent; None where it is none."""
    found = {path.name: path for path in shared_folder("conformance/polaris/fixtures").iterdir()}
    if file not in found:
        return None
    try:
        rows = read_waypoints_csv(found[file].read_bytes().decode()).tolist()
    except InvalidWaypointsError:
        return None
    return [{"x_m": x, "y_m": y, "yaw_rad": yaw} for x, y, yaw in rows]


LONG = [{"x_m": float(x), "y_m": 0.0, "yaw_rad": 0.0} for x in range(0, 101, 5)]


def steps_of(vector: Vector) -> Iterator[dict[str, Any]]:
    """Yield the steps of a scenario that does what the vector does."""
    start_task = vector["config"].get("waypoint_file")
    if start_task is not None:
        yield {"t_s": 0, "task": {"waypoints": waypoints(start_task)}}
    for step in vector["steps"]:
        if "signal" in step:
            for send in sends_of(step):
                yield from _reading(send.at_ms / 1000, send.signal, send.value, send.stamp_offset_s)
        elif step.get("task") == "cancel":
            yield {"t_s": step["t"], "task": None}
        elif "task" in step and (path := waypoints(step["file"])) is not None:
            yield {"t_s": step["t"], "task": {"waypoints": path}}


def _reading(t_s: float, signal: str, value: object, offset_s: float) -> Iterator[dict[str, Any]]:
    if signal == "task_status":
        # The planner has a status of its own: it follows from a task that stands for it.
        if value == "RUNNING_TASK":
            yield {"t_s": t_s, "task": {"waypoints": LONG}}
        elif value == "NO_TASK":
            yield {"t_s": t_s, "task": None}
        return
    yield {"t_s": t_s, "reading": {signal: value}, "stamp_offset_s": offset_s}


def seen_in(sample: Mapping[str, Any]) -> Seen:
    """Return what a reader sees in a sample."""
    state, task = sample["system_state"], sample["task"]
    assert state["error_code"] == sum(BITS[error] for error in state["errors"])
    return Seen(
        state=state["state"],
        errors=frozenset(state["errors"]),
        planner=state["task_status"],
        start_index=None if task is None else task["target_index"],
        active_goal_start_index=None,
        task_file=None,
        commanded_mps=sample["vehicle"]["command"]["speed_mps"],
        last_progress=None,
    )


def differences(vector: Vector, samples: list[dict[str, Any]], refused: bool) -> list[str]:
    """Return what the samples show otherwise than the vector expects."""
    found: list[str] = []
    seen_at: dict[int, Seen] = {}
    for look in vector[expectation(vector)]:
        for at_ms in looks_of(look):
            # The sample at the begin comes before the first step.
            sample = samples[max(at_ms // PERIOD_MS, 1)]
            seen_at[at_ms] = seen_in(sample)
            alternatives = look.get("any_of", [look])
            if not any(_fits(item, seen_at, at_ms, refused) for item in alternatives):
                found.append(f"{at_ms} ms: expected {look}, seen {sample['system_state']}")
    return found


def _fits(look: Mapping[str, Any], seen_at: dict[int, Seen], at_ms: int, refused: bool) -> bool:
    facts = {key: value for key, value in look.items() if key not in NOT_HERE}
    if facts.pop("error_code", None) not in (None, _code(seen_at[at_ms])):
        return False
    if facts.pop("input_rejected", refused) is not refused:
        return False
    return not list(wrong_keys(facts, seen_at, seen_at[at_ms]))


NOT_HERE = frozenset({"task_file"})
"""Names of files are not part of the interface."""


def _code(seen: Seen) -> int:
    return sum(BITS[error] for error in seen.errors)


@pytest.mark.parametrize("vector", VECTORS)
def test_a_simulation_shows_what_the_vector_says_unless_it_is_overruled(
    vector: Vector, service: BlockingService
) -> None:
    if "controller_stub" in vector["needs"]:
        pytest.skip(
            "the controller is scripted: tests/conformance/test_planner_vectors.py plays it"
        )
    steps = list(steps_of(vector))
    if any(
        math.isnan(v) for s in steps for v in s.get("reading", {}).values() if isinstance(v, float)
    ):
        pytest.skip("JSON has no NaN: test_polaris_vectors plays it")
    end_ms = max(at for look in vector[expectation(vector)] for at in looks_of(look))
    body = {
        "robot": {"signals": {"stale_after_s": vector["config"]["state_timeout_ms"] / 1000}},
        "until_s": end_ms / 1000 + 0.05,
        "sample_period_s": PERIOD_MS / 1000,
        "steps": steps,
    }
    simulated = service.post("/simulations", body)
    assert simulated.status_code == HTTPStatus.OK, simulated.text
    answer = simulated.json()
    refused = bool(answer["refusals"])
    found = differences(vector, answer["samples"], refused)

    if vector["name"] in OVERRULED:
        assert found, "the vector passes: it is not overruled"
    else:
        assert found == []
