"""What a device does not let its supervisor have a node do."""

from dataclasses import replace

from domain.changes.changing import Changing
from domain.changes.plan import TOWARDS_REST
from domain.commands import AskFacts, AskParameters, AskTransition, NodeCommand
from domain.health.health import Health
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import same_value
from domain.parts.parts import Parts
from domain.parts.targets import OF_REACTIONS
from domain.state_and_mode import DEFAULT_MODE, StateAndMode

SET_PARAMETERS = "set_parameters"

_S = LifecycleState
_KEPT_FROM = {
    Transition.ACTIVATE: (_S.INACTIVE, _S.UNCONFIGURED, _S.FINALIZED),
    Transition.CONFIGURE: (_S.UNCONFIGURED, _S.FINALIZED),
}
"""By transition, the targets that it would lead away from; one towards rest always passes."""


class OrderJudgement:
    """Judges orders of the supervisor's present session."""

    def __init__(self, parts: Parts, changing: Changing, health: Health) -> None:
        self._parts = parts
        self._changing = changing
        self._health = health

    def refusal(self, command: NodeCommand) -> str | None:
        """Return why an order is refused; None: it is not.

        Nothing is activated while the emergency stop is engaged here, whatever the supervisor knows
        of it.
        """
        if isinstance(command, AskFacts):
            return None
        is_activation = isinstance(command, AskTransition) and (
            command.transition is Transition.ACTIVATE
        )
        if is_activation and self._health.is_stopped:
            why = "; ".join(reason.message for reason in self._health.stop_reasons)
            return f"{command.node} is not activated while ESTOP is active: {why}"
        return self._against_reaction(command)

    def busy(self, command: NodeCommand) -> str | None:
        """Return what somebody requested at the device and ends first; None: nothing."""
        if isinstance(command, AskFacts):
            return None
        step = self._changing.step_in_flight(command.node)
        # What was canceled when the supervisor came back keeps nobody waiting: its node says no
        # itself as long as it is busy, and may never end the step if it died meanwhile.
        if step is not None and not self._changing.change(step.change).status.is_final:
            return f"{command.node} is busy on request of the device: {step.action_name}"
        return None

    @staticmethod
    def leads_to_rest(command: NodeCommand) -> bool:
        """Tell whether a command leads away from activity, and so may be late."""
        return isinstance(command, AskTransition) and command.transition in TOWARDS_REST

    def is_there(self, command: NodeCommand) -> bool:
        """Tell whether a node is where a transition would bring it."""
        if not isinstance(command, AskTransition):
            return False
        return self._parts.facts[command.node].known_state is command.transition.goal

    def _against_reaction(self, command: AskTransition | AskParameters) -> str | None:
        """Return that a reaction keeps a node where it is; None: none does, or it may rest."""
        node = command.node
        target = self._parts.view(node).effective_target
        if target is None or target.because not in OF_REACTIONS:
            return None
        if isinstance(command, AskTransition):
            is_against = target.state in _KEPT_FROM.get(command.transition, ())
        else:
            wanted = self._parts.model.nodes[node].modes.get(target.mode or DEFAULT_MODE, {})
            is_of_mode = target.state is LifecycleState.ACTIVE
            is_against = is_of_mode and any(
                name in wanted and not same_value(wanted[name], value)
                for name, value in command.values.items()
            )
        if not is_against:
            return None
        kept_in = StateAndMode(target.state, target.mode).label
        return f"reaction {target.reaction} keeps {node} in {kept_in}"


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
