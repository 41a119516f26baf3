"""Admission of changes: illegal requests are rejected, and blockers are found.

`GET .../modes` shows the same blockers that a request would meet.
"""

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import replace
from itertools import islice

from domain.changes.guards import Guards
from domain.changes.plan import TOWARDS_REST, ChangeGoal, NodeGoal, NodeGoals, goal_of, next_steps
from domain.changes.pursuit import goal_of_targets
from domain.errors import BlockedError, IllegalTransitionError
from domain.findings import Blocker
from domain.inputs import ChangeRequest, ModeRequest, TransitionRequest
from domain.lifecycle import LifecycleState, Transition, arrival, is_legal_request
from domain.parts.claims import Claims
from domain.parts.node_doubts import DEVICE_LOST, UNKNOWN_STATE, UNREACHABLE, doubt_of
from domain.parts.node_facts import NodeFacts
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName, StateAndMode

ADVISORY = frozenset({UNREACHABLE, UNKNOWN_STATE, DEVICE_LOST})
"""Shown, but no reason to reject: an absent node may reappear before the deadline."""

MAX_BLOCKERS = 100
"""Largest number of blockers of one request; more would not be read."""

_MODES_KEPT = 8


class ChangeAdmission:
    """Judges requests by the current facts about the nodes."""

    def __init__(
        self,
        model: SmhModel,
        facts: Mapping[PartName, NodeFacts],
        doubtful: Set[PartName],
        guards: Guards,
        claims: Claims,
    ) -> None:
        """Judge requests from here on.

        Args:
            model: The model.
            facts: Facts about all nodes.
            doubtful: Nodes in a state that is unknown, or that they do not leave; kept up to date.
            guards: Of all modes.
            claims: What reactions keep in force.
        """
        self._model = model
        self._facts = facts
        self._doubtful = doubtful
        self._guards = guards
        self._claims = claims
        self._goals = NodeGoals(model)
        self._of_modes: dict[tuple[PartName, str], ChangeGoal] = {}
        """The goals of requests for a mode that were judged last, the latest at the end."""

    def admit(self, request: ChangeRequest, estop: Sequence[Blocker]) -> ChangeGoal:
        """Return the goal of a request that may begin.

        Args:
            request: Its part, mode and parameters must be known to exist.
            estop: Why ESTOP is active; empty: it is not.

        Raises:
            IllegalTransitionError: There is no path from the current state of the part.
            BlockedError: The request is blocked.
        """
        if isinstance(request, TransitionRequest):
            self._check_legal(request, estop)
        goal = self.goal(request)
        blockers = self._blockers(request, goal, estop)
        if refuse(blockers):
            raise BlockedError(part_of(request), blockers)
        return goal

    def blockers(self, request: ChangeRequest, estop: Sequence[Blocker]) -> tuple[Blocker, ...]:
        """Return all blockers of a request, including the advisory ones."""
        return self._blockers(request, self.goal(request), estop)

    def goal(self, request: ChangeRequest) -> ChangeGoal:
        """Return the goal of a request, whatever blocks it.

        What a mode means for the parts below is always the same, and on a large robot much.
        """
        if not isinstance(request, ModeRequest):
            return goal_of(self._model, request, self._facts, self._goals)
        key = (request.part, request.mode)
        goal = self._of_modes.pop(key, None)
        if goal is None:
            goal = goal_of(self._model, request, self._facts, self._goals)
            if len(self._of_modes) == _MODES_KEPT:
                del self._of_modes[next(iter(self._of_modes))]
        self._of_modes[key] = goal
        return goal

    def goal_of_targets(self, targets: Mapping[PartName, StateAndMode]) -> ChangeGoal:
        """Return the goal that leads each of several parts to a target of its own."""
        return goal_of_targets(targets, self._facts, self._goals)

    def blockers_of(self, request: ChangeRequest, goal: ChangeGoal) -> tuple[Blocker, ...]:
        """Return what blocks a goal besides ESTOP, including what is advisory."""
        return self._blockers(request, goal, ())

    def would_activate(self, goal: ChangeGoal) -> bool:
        """Tell whether a goal would, or might, activate a node."""
        return any(self._activates(node, want) for node, want in goal.nodes.items())

    def available_transitions(
        self, part: PartName, estop: Sequence[Blocker]
    ) -> tuple[Transition, ...]:
        """Return the transitions that would be accepted now and change something.

        Wider than `get_available_transitions` of ROS 2, since a request implies a path: an
        unconfigured part can be activated, and is configured on the way.
        """
        states = self._lifecycles(part)
        return tuple(
            transition
            for transition in Transition
            if any(state is not transition.goal for state in states)
            and self._is_legal(transition, states)
            # Nothing blocks a legal transition towards rest, so nodes need not be checked.
            and (
                transition in TOWARDS_REST
                or not refuse(self.blockers(TransitionRequest(part, transition), estop))
            )
        )

    def _lifecycles(self, part: PartName) -> list[LifecycleState]:
        """Return the primary states that the lifecycle nodes below a part are in, or will reach."""
        below = [self._facts[node] for node in self._model.nodes_below(part)]
        return [arrival(facts.known_state) for facts in below if facts.has_lifecycle]

    def _check_legal(self, request: TransitionRequest, estop: Sequence[Blocker]) -> None:
        states = self._lifecycles(request.part)
        if not self._is_legal(request.transition, states):
            state = states[0] if len(set(states)) == 1 else None
            if not states:
                state = LifecycleState.ACTIVE
            available = self.available_transitions(request.part, estop)
            raise IllegalTransitionError(request.part, request.transition, state, available)

    @staticmethod
    def _is_legal(transition: Transition, states: Sequence[LifecycleState]) -> bool:
        """Judge by all nodes below: towards rest, one legal node is enough; otherwise all must be.

        An unknown node makes nothing illegal. A finalized one is reported as a blocker, since no
        transition leads out of it; towards rest it is left out. Plain nodes are always active.
        """
        if not states:
            return transition is Transition.ACTIVATE
        if transition in TOWARDS_REST:
            return any(
                state is LifecycleState.UNKNOWN or is_legal_request(transition, state)
                for state in states
            )
        passing = (LifecycleState.UNKNOWN, LifecycleState.FINALIZED)
        return all(state in passing or is_legal_request(transition, state) for state in states)

    def _blockers(
        self, request: ChangeRequest, goal: ChangeGoal, estop: Sequence[Blocker]
    ) -> tuple[Blocker, ...]:
        """Find the blockers of a request: those that reject it first, at most `MAX_BLOCKERS`."""
        part = part_of(request)
        resting = isinstance(request, TransitionRequest) and request.transition in TOWARDS_REST
        facts = self._facts
        doubtful: list[PartName] = []
        if not self._doubtful.isdisjoint(goal.nodes):
            doubtful = [node for node in goal.nodes if node in self._doubtful]
        # Those that reject come first; of the others, no more are made than are told.
        doubtful.sort(key=lambda node: facts[node].known_state is LifecycleState.UNKNOWN)
        doubts = (self._doubt(part, node, goal.nodes[node], resting) for node in doubtful)
        blockers = list(islice(filter(None, doubts), MAX_BLOCKERS))
        blockers = [*self.guard_blockers(part, goal), *blockers]
        if not resting:
            blockers = [*self._claims.against(part, goal.targets), *blockers]
        if estop and self.would_activate(goal):
            blockers = [replace(why, path=(part, *why.path)) for why in estop] + blockers
        return tuple(blockers[:MAX_BLOCKERS])

    def guard_blockers(self, part: PartName, goal: ChangeGoal) -> list[Blocker]:
        """Return the guards that do not hold, of the requested part first."""
        failing = self._guards.failing(goal.targets.keys())
        found = islice(self._guards.blockers(failing, goal.targets), MAX_BLOCKERS)
        return [replace(blocker, path=self._path_of_guard(part, blocker)) for blocker in found]

    def _path_of_guard(self, part: PartName, blocker: Blocker) -> tuple[str, ...]:
        owner, *below = blocker.path
        return (*self._model.path_down(part, PartName(owner)), *below)

    def _activates(self, node: PartName, goal: NodeGoal) -> bool:
        """Tell whether a node would, or in an unknown state might, be activated."""
        if goal.state is not LifecycleState.ACTIVE:
            return False
        facts = self._facts[node]
        if facts.known_state is LifecycleState.UNKNOWN:
            return facts.has_lifecycle
        return Transition.ACTIVATE in (next_steps(facts, goal) or ())

    def _doubt(
        self, part: PartName, node: PartName, goal: NodeGoal, resting: bool
    ) -> Blocker | None:
        """Return what blocks a node from its goal, or is not known of it; None: nothing does."""
        facts = self._facts[node]
        state = facts.known_state
        if state is not LifecycleState.UNKNOWN and (resting or goal.state is state):
            return None
        doubt = doubt_of(node, facts, self._model.path_down(part, node))
        return doubt and replace(doubt, refuses=doubt.code not in ADVISORY)


def refuse(blockers: Iterable[Blocker]) -> bool:
    """Tell whether a request with these blockers is rejected."""
    return any(blocker.refuses for blocker in blockers)


def part_of(request: ChangeRequest) -> PartName:
    """Return the part that a request is addressed to."""
    return request.part if isinstance(request, ModeRequest | TransitionRequest) else request.node
