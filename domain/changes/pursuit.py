"""What leads parts to targets in force that nobody requests anew."""

from collections.abc import Mapping

from domain.actor import Actor
from domain.changes.plan import ChangeGoal, NodeGoals
from domain.inputs import ChangeRequest, ModeRequest, TransitionRequest
from domain.lifecycle import LifecycleState, Transition, arrival
from domain.parts.node_facts import NodeFacts
from domain.parts.system_model import SmhModel
from domain.state_and_mode import DEFAULT_MODE, PartName, StateAndMode


def request_towards(
    model: SmhModel,
    facts: Mapping[PartName, NodeFacts],
    part: PartName,
    target: StateAndMode,
    actor: Actor,
) -> ChangeRequest:
    """Return the request that brings a part to a target.

    A system becomes inactive by a deactivation, which configures nothing; a node that is not active
    yet becomes inactive by a configuration.

    Args:
        model: The model.
        facts: Facts about all nodes.
        part: A part of the model.
        target: Its state must be a primary one.
        actor: In whose name.
    """
    if target.state is LifecycleState.ACTIVE:
        if model.modes_of(part):
            return ModeRequest(part, target.mode or DEFAULT_MODE, actor)
        return TransitionRequest(part, Transition.ACTIVATE, actor)
    if target.state is LifecycleState.UNCONFIGURED:
        return TransitionRequest(part, Transition.CLEANUP, actor)
    if target.state is LifecycleState.FINALIZED:
        return TransitionRequest(part, Transition.SHUTDOWN, actor)
    below = facts.get(part)
    is_configured_only = below is not None and (
        arrival(below.known_state) is not LifecycleState.ACTIVE
    )
    transition = Transition.CONFIGURE if is_configured_only else Transition.DEACTIVATE
    return TransitionRequest(part, transition, actor)


def goal_of_targets(
    targets: Mapping[PartName, StateAndMode],
    facts: Mapping[PartName, NodeFacts],
    goals: NodeGoals,
) -> ChangeGoal:
    """Return the goal that leads each of several parts to a target of its own.

    A plain node is always active, and left out where it is to be anything else.

    Args:
        targets: By part, systems and nodes.
        facts: Facts about all nodes.
        goals: Of the nodes of the model.
    """
    active = LifecycleState.ACTIVE
    nodes = {
        part: goals.of(part, target)
        for part, target in targets.items()
        if part in facts and (facts[part].has_lifecycle or target.state is active)
    }
    return ChangeGoal(targets, nodes)
