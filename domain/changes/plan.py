"""The targets that a change sets for each part, and the steps that lead a node there.

Pure functions: a dry run shows the same plan that a change follows.

Source: micro-ROS deliverable D4.8, section 4.1.2; requests in micro-ROS system_modes issues #25 and
#27 (find the path of transitions) and #60 (no redundant requests).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from domain.inputs import ChangeRequest, ModeRequest, ParametersRequest, TransitionRequest
from domain.lifecycle import LifecycleState, Transition, arrival, path
from domain.parameters import Parameters, same_value
from domain.parts.node_facts import NodeFacts
from domain.parts.system_model import SmhModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

TOWARDS_REST = (Transition.DEACTIVATE, Transition.CLEANUP, Transition.SHUTDOWN)
"""Transitions of a system that apply only to the parts in which they are legal."""


@dataclass(frozen=True, slots=True)
class SetParameters:
    """The step that sets parameters atomically: all or none."""

    values: Parameters
    mode: ModeName | None = None
    """The step is done only when a node that reports its mode reports this one."""


Action: TypeAlias = Transition | SetParameters


@dataclass(frozen=True, slots=True)
class NodeGoal:
    """Target state, mode and parameters of a node."""

    state: LifecycleState | None
    """None: any state."""
    mode: ModeName | None = None
    parameters: Parameters = field(default_factory=dict)
    configures: bool = True
    """False: a node that turns out to be unconfigured stays so; deactivating never configures."""
    setting: SetParameters = field(init=False, compare=False, repr=False)
    """The step that sets the parameters; one object for all plans towards this goal."""

    def __post_init__(self) -> None:
        """Prepare the step."""
        object.__setattr__(self, "setting", SetParameters(self.parameters, self.mode))


@dataclass(frozen=True, slots=True)
class ChangeGoal:
    """What a request means for the requested part and all parts below it."""

    targets: Mapping[PartName, StateAndMode]
    """New targets; empty for a request that only sets parameters."""
    nodes: Mapping[PartName, NodeGoal]


class NodeGoals:
    """The goals of the nodes of a model: one object for all changes that want the same of a node.

    They are made with the model: ten thousand objects for each change that is kept would be looked
    through by every garbage collection, while those that exist at the start are left out.
    """

    def __init__(self, model: SmhModel) -> None:
        self._in_mode = {
            name: {
                mode: NodeGoal(LifecycleState.ACTIVE, mode, parameters)
                for mode, parameters in node.modes.items()
            }
            for name, node in model.nodes.items()
            if node.modes
        }
        self._in_state = {
            configures: {state: NodeGoal(state, configures=configures) for state in LifecycleState}
            for configures in (True, False)
        }
        self._of_parts = {
            name: {
                mode: {part: self.of(part, want) for part, want in wanted.items()}
                for mode, wanted in system.modes.items()
                if wanted.keys() <= model.nodes.keys()
            }
            for name, system in model.systems.items()
        }

    def of(self, node: PartName, target: StateAndMode, *, configures: bool = True) -> NodeGoal:
        """Return the goal of a node whose target is `target`."""
        if target.state is LifecycleState.ACTIVE and node in self._in_mode:
            return self._in_mode[node][target.mode or DEFAULT_MODE]
        return self._in_state[configures][target.state]

    def of_parts(self, system: PartName, mode: ModeName) -> Mapping[PartName, NodeGoal]:
        """Return the goals of the parts of a system in a mode, all of which must be nodes."""
        return self._of_parts[system].get(mode, {})


def goal_of(
    model: SmhModel,
    request: ChangeRequest,
    facts: Mapping[PartName, NodeFacts],
    goals: NodeGoals | None = None,
) -> ChangeGoal:
    """Return the goal of a request for each part.

    Activating without a mode means `__DEFAULT__`. Nodes in which a transition of their system is
    not legal, such as an unconfigured one when the system is deactivated, keep their state. For a
    plain node, a transition of its system only sets parameters.

    Args:
        model: The model.
        request: Its part and mode must be known to exist.
        facts: Facts about all nodes.
        goals: Shared by all requests of a model; None: for this one only.
    """
    if isinstance(request, ParametersRequest):
        return ChangeGoal({}, {request.node: NodeGoal(None, None, dict(request.values))})
    if isinstance(request, ModeRequest):
        wanted = StateAndMode(LifecycleState.ACTIVE, model.require_mode(request.part, request.mode))
    elif request.transition is Transition.ACTIVATE:
        mode = DEFAULT_MODE if model.modes_of(request.part) else None
        wanted = StateAndMode(LifecycleState.ACTIVE, mode)
    else:
        wanted = StateAndMode(request.transition.goal)
    goals = goals or NodeGoals(model)
    # A transition asks something else of each node, depending on the state that it is in.
    spreading = _Spreading(model, None if isinstance(request, TransitionRequest) else goals)
    spreading.spread(request.part, wanted)
    targets = spreading.targets
    if not isinstance(request, TransitionRequest):
        return ChangeGoal(targets, spreading.nodes)
    _pass_by(request, facts, targets)
    configures = request.transition is not Transition.DEACTIVATE
    nodes = {
        part: goals.of(part, targets[part], configures=configures)
        for part in targets
        if part in facts and not _is_left_out(request, part, targets[part], facts[part])
    }
    return ChangeGoal(targets, nodes)


class _Spreading:
    """Records the targets of a part and of all parts below it, and the goals of the nodes."""

    def __init__(self, model: SmhModel, goals: NodeGoals | None) -> None:
        """Begin with none; without `goals`, those of the nodes are left out."""
        self.targets: dict[PartName, StateAndMode] = {}
        self.nodes: dict[PartName, NodeGoal] = {}
        self._model = model
        self._goals = goals

    def spread(self, part: PartName, wanted: StateAndMode) -> None:
        """Record a target; of a part shared by two systems, the first one in the file counts."""
        if part in self.targets:
            return
        self.targets[part] = wanted
        system = self._model.systems.get(part)
        if system is None:
            if self._goals is not None:
                self.nodes[part] = self._goals.of(part, wanted)
            return
        if wanted.state is not LifecycleState.ACTIVE:
            wants: Mapping[PartName, StateAndMode] = dict.fromkeys(system.parts, wanted)
        else:
            mode = wanted.mode or DEFAULT_MODE
            wants = system.modes.get(mode, {})
            if self._all_at_once(part, mode, wants):
                return
        for child, want in wants.items():
            self.spread(child, want)

    def _all_at_once(
        self, system: PartName, mode: ModeName, wants: Mapping[PartName, StateAndMode]
    ) -> bool:
        """Record nodes in bulk, since there may be ten thousand; return whether that was right."""
        if not (wants.keys() <= self._model.nodes.keys() and self.targets.keys().isdisjoint(wants)):
            return False
        self.targets.update(wants)
        if self._goals is not None:
            self.nodes.update(self._goals.of_parts(system, mode))
        return True


def _pass_by(
    request: TransitionRequest,
    facts: Mapping[PartName, NodeFacts],
    targets: dict[PartName, StateAndMode],
) -> None:
    """Set the target of nodes to which `request` does not apply to their current state."""
    for part in targets.keys() & facts.keys() - {request.part}:
        resting = arrival(facts[part].known_state)
        if _stays(resting, request.transition):
            targets[part] = StateAndMode(resting)


def _stays(state: LifecycleState, transition: Transition) -> bool:
    """Tell whether a node in `state` stays there when its system goes towards rest."""
    if transition is Transition.DEACTIVATE and state is LifecycleState.UNCONFIGURED:
        return True
    return transition in TOWARDS_REST and state is LifecycleState.FINALIZED


def _is_left_out(
    request: TransitionRequest, part: PartName, target: StateAndMode, facts: NodeFacts
) -> bool:
    """Tell whether a transition of its system leaves a plain node out.

    A plain node is always active, and must not block the others.
    """
    is_asked_itself = part == request.part
    return not (is_asked_itself or facts.has_lifecycle or target.state is LifecycleState.ACTIVE)


def targets_of(
    model: SmhModel, part: PartName, wanted: StateAndMode
) -> dict[PartName, StateAndMode]:
    """Return the targets of a part and of all parts below it, whatever state the nodes are in."""
    spreading = _Spreading(model, None)
    spreading.spread(part, wanted)
    return spreading.targets


def next_steps(facts: NodeFacts, goal: NodeGoal) -> tuple[Action, ...] | None:
    """Return the steps from the state of a node, or the one it will reach, to its goal.

    Parameters are set before the node is activated, so that it never runs in a mode that nobody
    requested. The state must be known. Returns None if there is no path.
    """
    transitions: tuple[Transition, ...] | None = ()
    if goal.state is not None:
        start = arrival(facts.known_state)
        if not facts.has_lifecycle:
            transitions = () if goal.state is start else None
        elif goal.configures or start is not LifecycleState.UNCONFIGURED:
            transitions = path(start, goal.state)
    if transitions is None:
        return None
    if not _parameters_missing(facts, goal):
        return transitions
    setting = goal.setting
    if transitions and transitions[-1] is Transition.ACTIVATE:
        return (*transitions[:-1], setting, transitions[-1])
    return (*transitions, setting)


def _parameters_missing(facts: NodeFacts, goal: NodeGoal) -> bool:
    """Tell whether parameters must be set: a value differs, or the node reports another mode."""
    if goal.mode is not None and facts.mode is not None and facts.mode != goal.mode:
        return True
    known = facts.parameters
    # A plain loop, which is faster than a generator.
    for name, value in goal.parameters.items():
        if name not in known or not same_value(known[name], value):
            return True
    return False


def presumed_steps(goal: NodeGoal) -> tuple[Action, ...]:
    """Return the last step towards a goal, for a node in an unknown state."""
    if goal.state is None or goal.state is LifecycleState.UNKNOWN:
        return (SetParameters(goal.parameters),)
    if not goal.configures:
        return (Transition.DEACTIVATE,)
    for transition in Transition:
        if transition.goal is goal.state:
            return (transition,)
    return ()
