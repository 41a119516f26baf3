"""The vectors of smart_polaris on state and signals (groups 01 to 08), played on the state manager.

Two kinds are played with another expectation than that of the original code: where the vector calls
it unsafe (`should_differ`), its safer alternative holds; where docs/conformance.md overrules it,
`OVERRULED` says why.
"""

from collections.abc import Mapping
from dataclasses import replace

import pytest

from domain.errors import PilothouseError
from domain.health.signals import default_signals
from domain.health.state_manager import StateManager
from domain.inputs import Reading, Readings, TimePassed
from domain.parts.system_model import SmhModel
from domain.snapshot import TaskStatus
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import NANOSECONDS_PER_SECOND, seconds
from tests.support.polaris import Observation, Send, Vector, play, timeline
from tests.support.shared import json_cases

VECTORS = json_cases("conformance/polaris/vectors", "0[1-8]_*.json", "vectors")

_INCLUSIVE = "The limit belongs to the time: the README says `>=`, the code of smart_polaris `>`."
_ARRIVAL = "Age is counted from when a reading arrived; a sender's stamp makes it no older."

OVERRULED: Mapping[str, str] = {
    "gps_exactly_15_0s_no_error": _INCLUSIVE,
    "low_exactly_20_0s_no_error": _INCLUSIVE,
    "notconn_exactly_10_0s_no_error": _INCLUSIVE,
    "rostest_3_as_really_published_frozen_stamp": _ARRIVAL,
    "gps_old_stamp_good_does_not_reset": _ARRIVAL,
    "stale_old_stamp_stream_is_stale": _ARRIVAL,
    "lost_then_low_clears_until_20s": (
        "Only CONNECTED ends an error of the radio: SIGNAL_LOW follows SIGNAL_LOST without a gap, "
        "so that the robot does not drive off for 9 s in between."
    ),
}
"""Vectors whose expectation does not hold here, with the reason."""


class OverStateManager:
    """A robot that is nothing but a state manager in virtual time."""

    def __init__(self, vector: Vector) -> None:
        stale_after = seconds(vector["config"]["state_timeout_ms"] / 1000)
        settings = [replace(item, stale_after=stale_after) for item in default_signals()]
        # Not 0, since a clock that has run for a while must make no difference.
        self._start = self._now = 86_400 * NANOSECONDS_PER_SECOND
        self._health = StateManager(settings, self._start)
        self._task_status = TaskStatus.NO_TASK

    def advance_to(self, at_s: float) -> None:
        self._now = self._start + seconds(at_s)
        self._health.pass_time(self._now)

    def reading(self, signal: str, value: object, stamp_offset_s: float) -> bool:
        stamp = self._now + seconds(stamp_offset_s)
        readings = Readings((Reading(signal, value, stamp),), source="vector")  # type: ignore[arg-type]
        try:
            self._health.check(readings, self._now)
        except PilothouseError:
            return False
        self._health.receive(readings, self._now)
        return True

    def task_status(self, status: str) -> None:
        self._task_status = TaskStatus(status)

    def observe(self) -> Observation:
        view = self._health.system_state(self._task_status)
        return Observation(str(view.state), frozenset(view.errors), view.error_code)


class OverSupervision(OverStateManager):
    """The whole core in virtual time; it is told nothing of tasks."""

    def __init__(self, vector: Vector) -> None:
        super().__init__(vector)
        stale_after = seconds(vector["config"]["state_timeout_ms"] / 1000)
        signals = tuple(replace(item, stale_after=stale_after) for item in default_signals())
        self._core = Supervision(SmhModel({}, {}), SupervisionSettings(signals), self._start)

    def advance_to(self, at_s: float) -> None:
        self._now = self._start + seconds(at_s)
        self._core.handle(TimePassed(), self._now)

    def reading(self, signal: str, value: object, stamp_offset_s: float) -> bool:
        stamp = self._now + seconds(stamp_offset_s)
        readings = Readings((Reading(signal, value, stamp),), source="vector")  # type: ignore[arg-type]
        try:
            self._core.handle(readings, self._now)
        except PilothouseError:
            return False
        return True

    def observe(self) -> Observation:
        view = self._core.system_state()
        return Observation(str(view.state), frozenset(view.errors), view.error_code)


def expectation(vector: Vector) -> str:
    """Name the list of expectations that is ours."""
    return "expected_safer" if vector["successor"] == "should_differ" else "expected"


@pytest.mark.parametrize("driver", [OverStateManager, OverSupervision])
@pytest.mark.parametrize("vector", VECTORS)
def test_the_robot_does_what_the_vector_says_unless_it_is_overruled(
    vector: Vector, driver: type[OverStateManager]
) -> None:
    if driver is OverSupervision and "task_status_injection" in vector["needs"]:
        pytest.skip("the core has a planner of its own: test_planner_vectors serves a real task")
    failures = play(vector, driver(vector), expectation(vector))

    if vector["name"] in OVERRULED:
        assert failures, "the vector passes: it is not overruled"
    else:
        assert failures == []


def test_every_overruled_vector_exists() -> None:
    names = {case.values[0]["name"] for case in VECTORS if case.values[0]}  # type: ignore[attr-defined]
    if not names:
        pytest.skip("the vectors are not beside this checkout")

    assert OVERRULED.keys() <= names


# --- the player itself ---------------------------------------------------------------------------

LOW_BATTERY: Vector = {
    "name": "low_battery",
    "config": {"state_timeout_ms": 0},
    "steps": [{"t": 0.5, "signal": "battery_level", "value": 0.4}],
    "expected": [
        {"from": 0.0, "to": 0.45, "state": "IDLE", "errors": []},
        {"t": 0.5, "state": "ERROR", "errors": ["BATTERY_LOW"]},
    ],
}


class Deaf(OverStateManager):
    """A robot that takes every reading and judges none."""

    def reading(self, signal: str, value: object, stamp_offset_s: float) -> bool:
        return True


class Refusing(OverStateManager):
    """A robot that takes no reading."""

    def reading(self, signal: str, value: object, stamp_offset_s: float) -> bool:
        return False


def test_the_player_passes_a_robot_that_does_as_expected() -> None:
    assert play(LOW_BATTERY, OverStateManager(LOW_BATTERY)) == []


def test_the_player_notices_what_is_not_seen() -> None:
    (failure,) = play(LOW_BATTERY, Deaf(LOW_BATTERY))

    assert failure.startswith("500 ms: expected")


def test_the_player_notices_a_reading_that_should_have_been_taken() -> None:
    failures = play(LOW_BATTERY, Refusing(LOW_BATTERY))

    assert failures[0].startswith("500 ms: refused")


def test_a_repeated_step_ends_with_its_window_and_ramps_over_it() -> None:
    step = {"t": 1.0, "signal": "battery_level", "ramp": [1.0, 0.8], "repeat_hz": 10, "until": 1.2}
    sent = timeline({"steps": [step], "expected": []})

    assert [(item.at_ms, item.value) for item in sent if isinstance(item, Send)] == [
        (1000, 1.0),
        (1100, 0.9),
        (1200, 0.8),
    ]


def test_a_frozen_stamp_falls_behind() -> None:
    step = {"t": 0, "signal": "estop", "value": False, "repeat_hz": 2, "until": 1, "stamp": "first"}
    sent = timeline({"steps": [step], "expected": []})

    assert [item.stamp_offset_s for item in sent if isinstance(item, Send)] == [0.0, -0.5, -1.0]
