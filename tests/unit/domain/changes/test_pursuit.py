"""Requests and goals that lead to targets which are in force already."""

import pytest

from domain.actor import NOBODY
from domain.changes.plan import NodeGoals
from domain.changes.pursuit import goal_of_targets, request_towards
from domain.inputs import ChangeRequest, ModeRequest, NodeReport, TransitionRequest
from domain.lifecycle import LifecycleState, Transition
from domain.parts.node_facts import NodeFacts
from domain.parts.system_model import NodeModel, SmhModel
from domain.state_and_mode import PartName, StateAndMode
from tests.support.models import ACTUATION, ARM, BASE, active, actuation_model, inactive

S, T = LifecycleState, Transition
LIDAR = PartName("lidar")
MODEL = SmhModel(
    {**actuation_model().nodes, LIDAR: NodeModel(LIDAR)},
    actuation_model().systems,
)


def facts(**states: LifecycleState) -> dict[PartName, NodeFacts]:
    found = {node: NodeFacts() for node in MODEL.nodes}
    for node, state in states.items():
        found[PartName(node)].take(NodeReport(PartName(node), state, reachable=True), 0)
    return found


@pytest.mark.parametrize(
    ("part", "target", "wanted"),
    [
        (ACTUATION, active("MODERATE"), ModeRequest(ACTUATION, "MODERATE")),
        (ACTUATION, StateAndMode(S.ACTIVE), ModeRequest(ACTUATION, "__DEFAULT__")),
        (LIDAR, StateAndMode(S.ACTIVE), TransitionRequest(LIDAR, T.ACTIVATE)),
        (ACTUATION, inactive(), TransitionRequest(ACTUATION, T.DEACTIVATE)),
        (BASE, inactive(), TransitionRequest(BASE, T.DEACTIVATE)),
        (ARM, inactive(), TransitionRequest(ARM, T.CONFIGURE)),
        (ARM, StateAndMode(S.UNCONFIGURED), TransitionRequest(ARM, T.CLEANUP)),
        (ACTUATION, StateAndMode(S.FINALIZED), TransitionRequest(ACTUATION, T.SHUTDOWN)),
    ],
    ids=lambda value: value.label if isinstance(value, StateAndMode) else "",
)
def test_a_target_has_the_request_that_leads_there(
    part: PartName, target: StateAndMode, wanted: ChangeRequest
) -> None:
    known = facts(drive_base=S.ACTIVE, manipulator=S.UNCONFIGURED)

    assert request_towards(MODEL, known, part, target, NOBODY) == wanted


def test_each_part_is_led_to_its_own_target() -> None:
    targets = {ACTUATION: active("PERFORMANCE"), BASE: active("SLOW"), ARM: inactive()}

    goal = goal_of_targets(targets, facts(), NodeGoals(MODEL))

    assert goal.targets == targets
    assert {node: (own.state, own.mode) for node, own in goal.nodes.items()} == {
        BASE: (S.ACTIVE, "SLOW"),
        ARM: (S.INACTIVE, None),
    }


def test_a_plain_node_is_left_out_where_it_is_to_rest() -> None:
    known = facts()
    known[BASE].take(NodeReport(BASE, has_lifecycle=False, reachable=True), 0)
    goals = NodeGoals(MODEL)

    assert BASE not in goal_of_targets({BASE: inactive()}, known, goals).nodes
    assert BASE in goal_of_targets({BASE: active("SLOW")}, known, goals).nodes
