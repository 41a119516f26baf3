import pytest

from domain.lifecycle import Transition
from domain.simulation.node_settings import Fault, NodeSettings


def test_each_transition_takes_its_own_time() -> None:
    settings = NodeSettings(configure=1, activate=2, deactivate=3, cleanup=4, shutdown=5)

    assert {transition: settings.time_of(transition) for transition in Transition} == {
        Transition.CONFIGURE: 1,
        Transition.ACTIVATE: 2,
        Transition.DEACTIVATE: 3,
        Transition.CLEANUP: 4,
        Transition.SHUTDOWN: 5,
    }


@pytest.mark.parametrize("fault", Fault)
def test_only_silence_and_death_keep_a_node_from_being_heard(fault: Fault) -> None:
    assert fault.is_mute is (fault in {Fault.SILENT, Fault.DIE})
