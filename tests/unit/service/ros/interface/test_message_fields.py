from datetime import UTC, datetime

import pytest

from domain.lifecycle import LifecycleState, Transition
from domain.timebase import seconds
from service.ros.interface.message_fields import header, mode_event, nanoseconds, state, transition
from tests.support.manual_clock import ManualClock


def test_a_time_is_wall_time() -> None:
    clock = ManualClock(wall=datetime(2026, 1, 1, tzinfo=UTC))

    assert nanoseconds(clock, seconds(1.5)) == 1_767_225_601_500_000_000
    assert header(clock, seconds(1.5)) == {
        "stamp": {"sec": 1_767_225_601, "nanosec": 500_000_000},
        "frame_id": "",
    }


def test_a_machine_that_believes_in_1960_sends_no_negative_time() -> None:
    assert nanoseconds(ManualClock(wall=datetime(1960, 1, 1, tzinfo=UTC)), 0) == 0


def test_a_state_has_its_number_and_label() -> None:
    assert state(LifecycleState.ACTIVATING) == {"id": 13, "label": "activating"}


@pytest.mark.parametrize(
    ("start", "number"),
    [
        (LifecycleState.UNCONFIGURED, 5),
        (LifecycleState.INACTIVE, 6),
        (LifecycleState.ACTIVE, 7),
        (LifecycleState.ACTIVATING, 5),
    ],
)
def test_shutdown_has_the_number_of_its_start(start: LifecycleState, number: int) -> None:
    assert transition(Transition.SHUTDOWN, start) == {"id": number, "label": "shutdown"}


def test_a_transition_that_others_lead_to_has_its_own_number() -> None:
    activate = transition(Transition.ACTIVATE, LifecycleState.UNCONFIGURED)

    assert activate == {"id": 3, "label": "activate"}


def test_no_mode_is_an_empty_label() -> None:
    assert mode_event(7, None, None) == {
        "timestamp": 7,
        "start_mode": {"label": ""},
        "goal_mode": {"label": ""},
    }
