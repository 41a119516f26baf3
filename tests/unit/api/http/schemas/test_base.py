"""Values that several messages hold."""

from api.http.schemas.base import (
    BlockerJson,
    FindingJson,
    StateAndModeJson,
    timestamp,
    timestamp_or_none,
)
from domain.findings import Blocker, Finding
from domain.lifecycle import LifecycleState
from domain.state_and_mode import StateAndMode
from domain.timebase import seconds
from tests.support.manual_clock import ManualClock

CLOCK = ManualClock()


def test_a_time_is_utc_with_milliseconds() -> None:
    assert timestamp(CLOCK, seconds(61.0625)) == "2026-01-01T00:01:01.062Z"
    assert timestamp(CLOCK, 0) == "2026-01-01T00:00:00.000Z"


def test_no_time_is_none() -> None:
    assert timestamp_or_none(CLOCK, None) is None
    assert timestamp_or_none(CLOCK, 0) is not None


def test_a_state_without_a_mode_says_so() -> None:
    shown = StateAndModeJson.of(StateAndMode(LifecycleState.INACTIVE))

    assert shown.model_dump_json() == '{"state":"inactive","mode":null}'


def test_a_blocker_keeps_the_type_of_its_value() -> None:
    blocker = Blocker("ESTOP", "stopped", ("estop",), value=True, threshold=1, since=seconds(1))

    shown = BlockerJson.of(blocker, CLOCK)

    assert (shown.value, shown.threshold) == (True, 1)
    assert shown.since_at == "2026-01-01T00:00:01.000Z"


def test_a_blocker_shows_the_tree_of_its_causes() -> None:
    leaf = Blocker("UNKNOWN_VALUE", "gps was never seen", ("gps",), condition="gps < 1")
    root = Blocker("CONDITION", "not met", (), causes=(leaf,), condition="gps < 1 and estop")

    shown = BlockerJson.of(root, CLOCK)

    assert shown.condition == "gps < 1 and estop"
    (cause,) = shown.causes
    assert (cause.code, cause.condition, cause.causes) == ("UNKNOWN_VALUE", "gps < 1", [])


def test_a_finding_without_a_place_says_so() -> None:
    shown = FindingJson.of(Finding("warning", "ODD", "odd"))

    assert (shown.line, shown.column, shown.part) == (None, None, None)
