"""How a change proceeds: in which order, until when, and what it does on a failure."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from domain.changes.plan import TOWARDS_REST, ChangeGoal
from domain.inputs import ChangeRequest, ParametersRequest, TransitionRequest
from domain.parts.mode_settings import OnFailure, TransitionSettings
from domain.parts.system_model import SmhModel
from domain.plans.order import Order, order_of
from domain.state_and_mode import ModeName, PartName
from domain.timebase import Duration


@dataclass(frozen=True, slots=True)
class Schedule:
    """How a change proceeds; without settings, all nodes begin at once, and go on side by side."""

    order: Order = field(default_factory=Order)
    """Notes which nodes are done, and so belongs to one change."""
    deadline: Duration | None = None
    """Of the whole change; None: only its steps have deadlines."""
    on_failure: OnFailure = OnFailure.CONTINUE

    def without_rollback(self) -> "Schedule":
        """Return the same, in which a failure does not lead back: the other nodes go on."""
        if self.on_failure is not OnFailure.ROLLBACK:
            return self
        return replace(self, on_failure=OnFailure.CONTINUE)


def schedule_of(
    model: SmhModel,
    request: ChangeRequest,
    goal: ChangeGoal,
    mode_of: Callable[[PartName], ModeName | None],
) -> Schedule:
    """Return how the change that a request begins proceeds.

    The settings of the mode that is entered say so; of a part that goes towards rest, those of the
    mode that it is in, in reverse. Each system orders what is inside it. Deadline and what a
    failure leads to are those of the requested part.

    Args:
        model: The model.
        request: It was admitted.
        goal: What it means for each part.
        mode_of: Returns the actual mode of a part; None: it has none.
    """
    if isinstance(request, ParametersRequest) or not model.mode_settings:
        return Schedule()
    is_resting = isinstance(request, TransitionRequest) and request.transition in TOWARDS_REST

    def settings(part: PartName) -> TransitionSettings:
        target = goal.targets.get(part)
        mode = mode_of(part) if is_resting or target is None else target.mode
        return model.settings_of(part, mode).transition

    own = settings(request.part)
    order = order_of(model, request.part, goal.nodes, settings, is_reversed=is_resting)
    return Schedule(order, own.deadline, own.on_failure)
