"""Views are plain values; only what is derived in them can be wrong."""

from domain.lifecycle import LifecycleState
from domain.snapshot import Actual
from domain.state_and_mode import ModeName, StateAndMode


def test_state_and_mode_of_an_actual_leave_out_how_they_are_known() -> None:
    actual = Actual(LifecycleState.ACTIVE, ModeName("FAST"), inferred=True, mode_inferred=True)

    assert actual.state_and_mode == StateAndMode(LifecycleState.ACTIVE, ModeName("FAST"))
