"""What is known of one node."""

import pytest

from domain.findings import Blocker
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parts.node_facts import NodeFacts
from domain.state_and_mode import ModeName, PartName

ARM = PartName("arm")
STRONG = ModeName("STRONG")
ACTIVE, INACTIVE = LifecycleState.ACTIVE, LifecycleState.INACTIVE


def _facts(*reports: NodeReport) -> NodeFacts:
    facts = NodeFacts()
    for report in reports:
        facts.take(report)
    return facts


def test_a_node_that_never_spoke_is_unknown_and_not_said_to_be_unreachable() -> None:
    facts = NodeFacts()
    assert facts.known_state is LifecycleState.UNKNOWN
    assert facts.why_unknown == "has never reported a state"


def test_who_speaks_is_there() -> None:
    facts = _facts(NodeReport(ARM, state=INACTIVE))
    assert facts.reachable
    assert facts.known_state is INACTIVE


def test_a_late_word_of_a_lost_node_does_not_bring_it_back() -> None:
    """Whether a node can be reached is said by the backend, which hears of it first."""
    facts = _facts(NodeReport(ARM, reachable=False), NodeReport(ARM, state=ACTIVE))
    assert facts.known_state is LifecycleState.UNKNOWN
    facts.take(NodeReport(ARM, reachable=True))
    assert facts.known_state is ACTIVE


def test_a_node_that_is_there_but_told_no_state_is_unknown() -> None:
    facts = _facts(NodeReport(ARM, parameters={"torque": 0.1}))
    assert facts.known_state is LifecycleState.UNKNOWN
    assert facts.why_unknown == "has never reported a state"


def test_a_node_that_cannot_be_reached_is_unknown_whatever_it_said_before() -> None:
    facts = _facts(NodeReport(ARM, state=ACTIVE), NodeReport(ARM, reachable=False))
    assert facts.known_state is LifecycleState.UNKNOWN
    assert facts.why_unknown == "is unreachable"


@pytest.mark.parametrize(("reachable", "state"), [(True, ACTIVE), (False, LifecycleState.UNKNOWN)])
def test_a_plain_node_is_active_while_it_is_reachable(
    *, reachable: bool, state: LifecycleState
) -> None:
    """docs/explanation/inference.md; a plain node of system_modes has no `change_state`."""
    facts = _facts(NodeReport(ARM, reachable=reachable, has_lifecycle=False))
    assert facts.known_state is state


def test_whether_a_node_has_a_lifecycle_is_remembered() -> None:
    facts = _facts(NodeReport(ARM, has_lifecycle=False), NodeReport(ARM, parameters={"a": 1}))
    assert not facts.has_lifecycle


@pytest.mark.parametrize("state", [s for s in LifecycleState if s is not ACTIVE])
def test_leaving_active_ends_the_reported_mode(state: LifecycleState) -> None:
    """system_modes, `update_state`."""
    facts = _facts(NodeReport(ARM, state=ACTIVE, mode=STRONG), NodeReport(ARM, state=state))
    assert facts.mode is None


def test_staying_active_keeps_the_reported_mode() -> None:
    facts = _facts(NodeReport(ARM, state=ACTIVE, mode=STRONG), NodeReport(ARM, state=ACTIVE))
    assert facts.mode == STRONG


def test_a_mode_says_nothing_about_the_state() -> None:
    """Different from system_modes, where a mode event makes a node active."""
    assert _facts(NodeReport(ARM, mode=STRONG)).known_state is LifecycleState.UNKNOWN


def test_parameters_are_merged_by_name() -> None:
    facts = _facts(
        NodeReport(ARM, parameters={"torque": 0.1, "gain": 2}),
        NodeReport(ARM, parameters={"torque": 0.3}),
    )
    assert facts.parameters == {"torque": 0.3, "gain": 2}


FULL = NodeReport(
    ARM, ACTIVE, STRONG, parameters={"torque": 1.0}, reachable=True, has_lifecycle=True
)


@pytest.mark.parametrize(
    ("report", "different"),
    [
        (FULL, False),
        (NodeReport(ARM), False),
        (NodeReport(ARM, parameters={"torque": 1.0}), False),
        (NodeReport(ARM, parameters={"torque": 1}), True),
        (NodeReport(ARM, parameters={"torque": 2.0}), True),
        (NodeReport(ARM, parameters={"gain": 1.0}), True),
        (NodeReport(ARM, state=INACTIVE), True),
        (NodeReport(ARM, mode=ModeName("WEAK")), True),
        (NodeReport(ARM, reachable=False), True),
        (NodeReport(ARM, has_lifecycle=False), True),
    ],
    ids=str,
)
def test_a_report_tells_whether_it_is_news(report: NodeReport, *, different: bool) -> None:
    assert _facts(FULL).take(report) is different


def test_the_first_word_of_a_node_is_news_even_if_it_says_nothing() -> None:
    assert NodeFacts().take(NodeReport(ARM))


def test_a_node_whose_device_is_not_connected_says_so() -> None:
    lost = Blocker("DEVICE_LOST", "device arm is not connected", ())
    assert NodeFacts(cut_off=lost).why_unknown == (
        "has never reported a state: device arm is not connected"
    )
    assert NodeFacts(reachable=False, cut_off=lost).why_unknown == (
        "is unreachable: device arm is not connected"
    )
