"""The record of a change: its request, its steps and its result."""

from dataclasses import dataclass, field

from domain.changes.plan import Action, NodeGoal, SetParameters
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest
from domain.lifecycle import LifecycleState
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
        return "set_parameters" if isinstance(self.action, SetParameters) else str(self.action)

    def view(self) -> StepView:
        """Return this step as it is now."""
        action = self.action
        return StepView(
            self.node,
            "set_parameters" if isinstance(action, SetParameters) else action,
            self.status,
            self.started_at,
            self.ended_at,
            self.error,
        )


@dataclass(slots=True)
class Pursuit:
    """One node on its way to the goal of a change."""

    change: ChangeId
    node: PartName
    goal: NodeGoal
    steps: list[Step] = field(default_factory=list)
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
        done = [step for step in self.steps if step.status is not StepStatus.PENDING]
        pending = [step.action for step in self.steps if step.status is StepStatus.PENDING]
        if pending != list(actions):
            new = [Step(self.change, self.node, action) for action in actions]
            self.steps[:] = [*done, *new]

    def next_step(self) -> Step | None:
        """Return the first pending step; None: there is none."""
        return next((step for step in self.steps if step.status is StepStatus.PENDING), None)

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
    pursuits: dict[PartName, Pursuit] = field(default_factory=dict)
    open: set[PartName] = field(default_factory=set)
    """Nodes that are still on their way."""

    def errors_of(self, outcome: StepStatus) -> list[str]:
        """Return why nodes ended with `outcome`, in the order of the nodes."""
        return [p.error for p in self.pursuits.values() if p.outcome is outcome and p.error]

    def view(self) -> ChangeView:
        """Return this change as it is now."""
        steps = tuple(step.view() for p in self.pursuits.values() for step in p.steps)
        return ChangeView(
            self.id,
            self.part,
            self.request,
            self.status,
            self.reason,
            steps,
            self.started_at,
            self.ended_at,
            self.cause,
        )
