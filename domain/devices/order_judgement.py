"""What a device does not let its supervisor have a node do."""

from dataclasses import replace

from domain.changes.changing import Changing
from domain.commands import AskFacts, AskParameters, AskTransition, NodeCommand
from domain.health.health import Health
from domain.lifecycle import Transition
from domain.parts.parts import Parts

SET_PARAMETERS = "set_parameters"


class OrderJudgement:
    """Judges orders of the supervisor's present session."""

    def __init__(self, parts: Parts, changing: Changing, health: Health) -> None:
        self._parts = parts
        self._changing = changing
        self._health = health

    def refusal(self, command: NodeCommand) -> str | None:
        """Return why an order is refused; None: it is not.

        Nothing is activated while the emergency stop is engaged here, whatever the supervisor knows
        of it. A step that somebody requested at the device, such as to deactivate, ends first.
        """
        if isinstance(command, AskFacts):
            return None
        is_activation = isinstance(command, AskTransition) and (
            command.transition is Transition.ACTIVATE
        )
        if is_activation and self._health.is_stopped:
            why = "; ".join(reason.message for reason in self._health.stop_reasons)
            return f"{command.node} is not activated while ESTOP is active: {why}"
        step = self._changing.step_in_flight(command.node)
        if step is not None:
            return f"{command.node} is busy on request of the device: {step.action_name}"
        return None


def action_of(command: NodeCommand) -> str:
    """Return what a command asks for, as events name it."""
    match command:
        case AskTransition(transition=transition):
            return str(transition)
        case AskParameters():
            return SET_PARAMETERS
        case AskFacts():
            return "report"


def renumbered(command: NodeCommand, request: int) -> NodeCommand:
    """Return a command with another number."""
    return replace(command, request=request)
