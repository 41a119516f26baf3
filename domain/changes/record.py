"""The record of a change: its request, its steps and its result."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, overload

from domain.changes.plan import Action, NodeGoal, SetParameters
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest
from domain.lifecycle import LifecycleState, Transition
from domain.snapshot import ChangeStatus, ChangeView, StepStatus, StepView
from domain.state_and_mode import PartName, StateAndMode
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

    def __init__(self, steps: Sequence[Step]) -> None:
        """Copy steps as they are now."""
        actions: list[Transition | Literal["set_parameters"]] = [s.shown_action for s in steps]
        self._columns = (
            [step.node for step in steps],
            actions,
            [step.status for step in steps],
            [step.started_at for step in steps],
            [step.ended_at for step in steps],
            [step.error for step in steps],
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
        nodes, actions, statuses, started_at, ended_at, errors = self._columns
        if isinstance(index, slice):
            return tuple(self[number] for number in range(*index.indices(len(self))))
        return StepView(
            nodes[index],
            actions[index],
            statuses[index],
            started_at[index],
            ended_at[index],
            errors[index],
        )

    def __eq__(self, other: object) -> bool:
        """Tell whether the same steps are in another sequence, in the same order."""
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]


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

    @property
    def has_begun(self) -> bool:
        """Tell whether the node was asked for a step of this change."""
        return any(step.started_at is not None for step in self.steps)

    def plan(self, actions: tuple[Action, ...]) -> None:
        """Replace the pending steps, if the path to the goal has changed."""
        pending = [step.action for step in self.steps if step.status is StepStatus.PENDING]
        if pending != list(actions):
            done = [step for step in self.steps if step.status is not StepStatus.PENDING]
            new = [Step(self.change, self.node, action) for action in actions]
            self.steps = (*done, *new)

    def next_step(self) -> Step | None:
        """Return the first pending step; None: there is none."""
        for step in self.steps:
            if step.status is StepStatus.PENDING:
                return step
        return None

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

    def set_out(self, goals: Mapping[PartName, NodeGoal]) -> None:
        """Begin: all nodes wait for their turn.

        A pursuit is made when its turn comes: ten thousand at once would take longer than a turn
        may take, and Python's garbage collection would look through all of them.
        """
        self.goals, self.pursuits = goals, dict.fromkeys(goals)
        self.open, self.node_count = set(goals), len(goals)

    def pursue(self, node: PartName) -> Pursuit:
        """Return the new pursuit of a node whose turn has come."""
        pursuit = self.pursuits[node] = Pursuit(self.id, node, self.goals[node])
        return pursuit

    @property
    def is_over(self) -> bool:
        """Tell whether nothing about this change changes any more."""
        return self.status is not ChangeStatus.RUNNING and not self.open and not self.loose

    def errors_of(self, outcome: StepStatus) -> list[str]:
        """Return why nodes ended with `outcome`, in the order of the nodes."""
        return [p.error for p in self._begun() if p.outcome is outcome and p.error]

    def pack(self) -> None:
        """Keep only what `view` shows, of a change that has ended in all its nodes."""
        self.packed = self._table()
        self.goals, self.pursuits = {}, {}

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
        )

    def _table(self) -> StepTable:
        return StepTable([step for pursuit in self._begun() for step in pursuit.steps])

    def _begun(self) -> Iterator[Pursuit]:
        return (pursuit for pursuit in self.pursuits.values() if pursuit is not None)
