"""The record of a change: its request, its steps and its result."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, overload

from domain.changes.plan import Action, NodeGoal, SetParameters
from domain.changes.schedule import Schedule
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import ParameterValue
from domain.plans.durations import Durations
from domain.plans.order import Order
from domain.snapshot import ChangeStatus, ChangeView, Rollback, StepStatus, StepView
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.timebase import Instant


@dataclass(slots=True)
class Step:
    """One request to one node."""

    change: ChangeId
    node: PartName
    action: Action
    status: StepStatus = StepStatus.PENDING
    started_at: Instant | None = None
    ended_at: Instant | None = None
    error: str | None = None
    request: int = 0
    """Number of the command whose answer is awaited."""
    event: int | None = None
    """Id of the event that recorded the start of the step."""
    start_state: LifecycleState = LifecycleState.UNKNOWN
    seen_on_the_way: bool = False
    """The node reported the transitional state, so that a return to the start is a failure."""
    facts_asked: bool = False
    rollback: bool = False
    """It takes its node back to where it was."""

    def end(self, status: StepStatus, now: Instant, error: str | None = None) -> None:
        """Record how the step ended."""
        self.status, self.ended_at, self.error = status, now, error

    @property
    def action_name(self) -> str:
        """Return the name of the action for clients."""
        return str(self.shown_action)

    @property
    def shown_action(self) -> Transition | Literal["set_parameters"]:
        """Return the action as clients see it; not the values that it sets."""
        action = self.action
        return "set_parameters" if isinstance(action, SetParameters) else action


class StepTable(Sequence[StepView]):
    """Steps as they were at one moment, column by column; a view is made when it is read.

    A change of 10,000 nodes has 30,000 steps. An object for each would take longer to make than a
    turn may take, and Python's garbage collection would look through all that are kept.
    """

    def __init__(
        self, steps: Sequence[Step], order: Order, durations: Durations, back: Order | None = None
    ) -> None:
        """Copy steps as they are now.

        Args:
            steps: Of one change.
            order: Of its nodes.
            durations: How long steps took; read when a view is made.
            back: The order in which nodes go back; None: they do not.
        """
        self._order, self._back, self._durations = order, back or order, durations
        actions: list[Transition | Literal["set_parameters"]] = [s.shown_action for s in steps]
        self._columns = (
            [step.node for step in steps],
            actions,
            [step.status for step in steps],
            [step.started_at for step in steps],
            [step.ended_at for step in steps],
            [step.error for step in steps],
            [step.rollback for step in steps],
        )

    def __len__(self) -> int:
        """Return how many steps there are."""
        return len(self._columns[0])

    @overload
    def __getitem__(self, index: int) -> StepView: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[StepView, ...]: ...

    def __getitem__(self, index: int | slice) -> StepView | tuple[StepView, ...]:
        """Return one step, or several."""
        nodes, actions, statuses, started_at, ended_at, errors, rollbacks = self._columns
        if isinstance(index, slice):
            return tuple(self[number] for number in range(*index.indices(len(self))))
        node, action = nodes[index], actions[index]
        order = self._back if rollbacks[index] else self._order
        return StepView(
            node,
            action,
            statuses[index],
            started_at[index],
            ended_at[index],
            errors[index],
            order.stage(node),
            order.after(node),
            self._durations.expected(node, str(action)),
            rollbacks[index],
        )

    def __eq__(self, other: object) -> bool:
        """Tell whether the same steps are in another sequence, in the same order."""
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, slots=True)
class NodeBefore:
    """What a node was like before the first step of a change."""

    state: LifecycleState
    mode: ModeName | None
    """As it reported it; None: it has not."""
    parameters: Mapping[str, ParameterValue]
    """Those that the change sets, as far as they were known."""


@dataclass(slots=True)
class Pursuit:
    """One node on its way to the goal of a change."""

    change: ChangeId
    node: PartName
    goal: NodeGoal
    steps: Sequence[Step] = ()
    waiting: bool = False
    """No step can start, because the node's state is unknown or transitional."""
    facts_asked: bool = False
    outcome: StepStatus = StepStatus.RUNNING
    error: str | None = None
    is_last: bool = False
    """No step follows the one in flight."""
    before: NodeBefore | None = None
    """None: it was asked for nothing."""
    rollback: bool = False
    """It takes the node back to where it was."""

    @property
    def has_begun(self) -> bool:
        """Tell whether the node was asked for a step of this change."""
        return any(step.started_at is not None for step in self.steps)

    def plan(self, actions: tuple[Action, ...]) -> None:
        """Replace the pending steps, if the path to the goal has changed."""
        pending = [step.action for step in self.steps if step.status is StepStatus.PENDING]
        if pending != list(actions):
            done = [step for step in self.steps if step.status is not StepStatus.PENDING]
            new = [
                Step(self.change, self.node, action, rollback=self.rollback) for action in actions
            ]
            self.steps = (*done, *new)

    def next_step(self) -> Step | None:
        """Return the first pending step; None: there is none."""
        for step in self.steps:
            if step.status is StepStatus.PENDING:
                return step
        return None

    def end(self, outcome: StepStatus, error: str | None, now: Instant) -> None:
        """End the pursuit; unless it succeeded, the step that would be next ends like it."""
        self.outcome, self.error = outcome, error
        if outcome is not StepStatus.SUCCEEDED:
            step = self.next_step()
            if step is not None and not any(s.status is outcome for s in self.steps):
                step.end(outcome, now, error)
            self.drop_pending(StepStatus.CANCELED, now)

    def drop_pending(self, status: StepStatus, now: Instant) -> None:
        """End all pending steps."""
        for step in self.steps:
            if step.status is StepStatus.PENDING:
                step.end(status, now)


@dataclass(slots=True)
class Change:
    """One change of state, mode or parameters."""

    id: ChangeId
    part: PartName
    request: ChangeRequest
    targets: dict[PartName, StateAndMode]
    started_at: Instant
    cause: int
    schedule: Schedule = field(default_factory=Schedule)
    durations: Durations = field(default_factory=Durations)
    """Of all changes together."""
    unguarded: frozenset[PartName] | None = None
    """Parts of which the guards do not count; None: there are no guards."""
    status: ChangeStatus = ChangeStatus.RUNNING
    reason: str | None = None
    ended_at: Instant | None = None
    goals: Mapping[PartName, NodeGoal] = field(default_factory=dict)
    """Of each node; empty once the change is packed."""
    pursuits: dict[PartName, Pursuit | None] = field(default_factory=dict)
    """Of each node; None: it waits for its turn. Empty once the change is packed."""
    open: set[PartName] = field(default_factory=set)
    """Nodes that are still on their way."""
    loose: int = 0
    """Steps in flight of nodes that are no longer on their way; they end by themselves."""
    packed: StepTable | None = None
    """All steps, once none of them changes any more."""
    node_count: int = 0
    stage: int = 0
    """The highest one of which a node has begun."""
    deadline_at: Instant | None = None
    is_stopping: bool = False
    """No further step begins."""
    failure: tuple[ChangeStatus, str] | None = None
    """How it will end, and why, once its nodes are back."""
    targets_before: Mapping[PartName, StateAndMode | None] = field(default_factory=dict)
    """Requested targets before; only of a change that goes back on a failure."""
    rollback: Rollback | None = None
    forth: tuple[Pursuit, ...] = ()
    """What nodes did before they began to go back."""
    back: Order | None = None
    """In which order nodes go back; None: they do not."""

    def set_out(self, goals: Mapping[PartName, NodeGoal]) -> None:
        """Begin: all nodes wait for their turn.

        A pursuit is made when its turn comes: ten thousand at once would take longer than a turn
        may take, and Python's garbage collection would look through all of them.
        """
        self.goals, self.pursuits = goals, dict.fromkeys(goals)
        self.open, self.node_count = set(goals), len(goals)

    def turn_back(self, goals: Mapping[PartName, NodeGoal], order: Order) -> None:
        """Begin to take nodes back to where they were; none of them is on its way."""
        self.forth, self.back = tuple(self._begun()), order
        self.is_stopping = False
        self.set_out(goals)

    @property
    def is_going_back(self) -> bool:
        """Tell whether nodes go, or went, back to where they were."""
        return self.back is not None

    @property
    def order(self) -> Order:
        """Return the order in which nodes begin now."""
        return self.schedule.order if self.back is None else self.back

    def pursue(self, node: PartName) -> Pursuit:
        """Return the pursuit of a node; it is made when it is asked for first."""
        pursuit = self.pursuits[node]
        if pursuit is None:
            pursuit = Pursuit(self.id, node, self.goals[node], rollback=self.is_going_back)
            self.pursuits[node] = pursuit
        return pursuit

    def freed_by(self, node: PartName) -> list[PartName]:
        """Return the nodes that may begin once a node is done, but those that ended before it."""
        freed: list[PartName] = []
        done = [node]
        while done:
            for each in self.order.done(done.pop()):
                (freed if each in self.open else done).append(each)
        return freed

    def leave(self, nodes: Collection[PartName], status: StepStatus, now: Instant) -> None:
        """Note that nodes are not on their way any more; their pending steps end."""
        # In bulk: there may be ten thousand, of which few have begun.
        self.open.difference_update(nodes)
        for pursuit in filter(None, map(self.pursuits.get, nodes)):
            pursuit.drop_pending(status, now)

    @property
    def is_over(self) -> bool:
        """Tell whether nothing about this change changes any more."""
        return self.status.is_final and not self.open and not self.loose

    def errors_of(self, outcome: StepStatus) -> list[str]:
        """Return why nodes ended with `outcome`, in the order of the nodes."""
        return [p.error for p in self._begun() if p.outcome is outcome and p.error]

    def pack(self) -> None:
        """Keep only what `view` shows, of a change that has ended in all its nodes."""
        self.packed = self._table()
        self.goals, self.pursuits, self.forth = {}, {}, ()
        self.targets_before = {}

    def view(self) -> ChangeView:
        """Return this change as it is now."""
        return ChangeView(
            self.id,
            self.part,
            self.request,
            self.status,
            self.reason,
            self.packed or self._table(),
            self.started_at,
            self.ended_at,
            self.cause,
            self.stage,
            self.deadline_at,
            self.rollback,
        )

    def _table(self) -> StepTable:
        pursuits = (*self.forth, *self._begun())
        steps = [step for pursuit in pursuits for step in pursuit.steps]
        return StepTable(steps, self.schedule.order, self.durations, self.back)

    def _begun(self) -> Iterator[Pursuit]:
        return (pursuit for pursuit in self.pursuits.values() if pursuit is not None)
