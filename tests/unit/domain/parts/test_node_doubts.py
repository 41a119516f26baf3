from dataclasses import replace

import pytest

from domain.findings import Blocker
from domain.lifecycle import LifecycleState
from domain.parts.node_doubts import doubt_of
from domain.parts.node_facts import NodeFacts
from domain.state_and_mode import PartName

BASE = PartName("drive_base")


@pytest.mark.parametrize(
    ("facts", "code", "message"),
    [
        (NodeFacts(), "UNKNOWN_STATE", "drive_base has never reported a state"),
        (NodeFacts(reachable=False), "UNREACHABLE", "drive_base is unreachable"),
        (
            NodeFacts(LifecycleState.FINALIZED, reachable=True),
            "FINALIZED",
            "drive_base is finalized: its process must be restarted",
        ),
        (
            NodeFacts(LifecycleState.ERROR_PROCESSING, reachable=True),
            "ERROR_PROCESSING",
            "drive_base is processing an error",
        ),
    ],
)
def test_a_node_that_goes_nowhere_says_why(facts: NodeFacts, code: str, message: str) -> None:
    doubt = doubt_of(BASE, facts, ("actuation", BASE))

    assert doubt is not None
    assert (doubt.code, doubt.message, doubt.path) == (code, message, ("actuation", BASE))


def test_a_node_in_a_known_state_is_in_no_doubt() -> None:
    assert doubt_of(BASE, NodeFacts(LifecycleState.INACTIVE, reachable=True), (BASE,)) is None


def test_a_node_whose_device_is_lost_is_in_doubt_because_of_that() -> None:
    lost = Blocker("DEVICE_LOST", "device base is not connected", (), since=5, refuses=False)
    facts = NodeFacts(LifecycleState.ACTIVE, reachable=False, cut_off=lost)

    doubt = doubt_of(BASE, facts, ("actuation", BASE))

    assert doubt is not None
    assert doubt.message == "drive_base is unreachable: device base is not connected"
    assert not doubt.root_cause
    assert doubt.causes == (replace(lost, path=("actuation", BASE)),)
