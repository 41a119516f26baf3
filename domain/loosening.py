"""Which requests may start or loosen something, and so must not be forgotten once they are done."""

from collections.abc import Collection

from domain.inputs import (
    AcknowledgeReactionRequest,
    AcknowledgeRequest,
    ArmRequest,
    CancelRequest,
    CancelTaskRequest,
    EmergencyStopRequest,
    ErrorReport,
    HoldRequest,
    Input,
    ModeRequest,
    ParametersRequest,
    ReleaseRequest,
    ShelveRequest,
    TaskRequest,
    TransitionRequest,
    UnshelveRequest,
)
from domain.lifecycle import Transition
from domain.process_terms import ProcessAction, ProcessRequest

_RAISING = frozenset({Transition.CONFIGURE, Transition.ACTIVATE})


def may_loosen(given: Input, *, is_stopped: bool, holds: Collection[str]) -> bool:
    """Tell whether a request may start or loosen something as things are now.

    A release of what is released loosens nothing.

    Args:
        given: A request.
        is_stopped: Whether the emergency stop is engaged.
        holds: Owners of the holds that are set.

    Raises:
        TypeError: It is no request.
    """
    match given:
        case EmergencyStopRequest(engaged=engaged):
            return is_stopped and not engaged
        case ErrorReport(active=active):
            return not active
        case ReleaseRequest(owner=owner):
            return owner in holds
        case TransitionRequest(transition=transition):
            return transition in _RAISING
        case ProcessRequest(action=action):
            return action is not ProcessAction.STOP
        case TaskRequest() | AcknowledgeRequest() | ShelveRequest():
            return True
        case ArmRequest() | AcknowledgeReactionRequest():
            return True
        case ModeRequest() | ParametersRequest():
            return True
        case HoldRequest() | CancelRequest() | CancelTaskRequest() | UnshelveRequest():
            return False
    raise TypeError(f"{type(given).__name__} is no request")
