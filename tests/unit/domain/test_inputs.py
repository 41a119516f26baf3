"""What an earlier run left, and whether there was one."""

import pytest

from domain.inputs import Restored
from domain.kept import KeptHold

HOLD = KeptHold("operator", "lunch", "http:10.0.0.7", 5)


@pytest.mark.parametrize(
    "restored",
    [Restored(boot=2), Restored((HOLD,)), Restored(stop_because="state.db was put aside")],
)
def test_after_an_earlier_run_parts_wait_for_an_operator(restored: Restored) -> None:
    assert restored.is_restart


def test_the_first_run_of_a_robot_is_no_restart() -> None:
    assert not Restored().is_restart
