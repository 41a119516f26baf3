"""What starts or loosens something is told from what makes the robot safer, or changes nothing."""

from typing import get_args

import numpy as np
import pytest

from domain.health.signals import ESTOP
from domain.identifiers import ChangeId
from domain.inputs import (
    AcknowledgeRequest,
    CancelRequest,
    CancelTaskRequest,
    ChangeRequest,
    DriveRequest,
    EmergencyStopRequest,
    HoldRequest,
    Input,
    ModeRequest,
    ParametersRequest,
    ReleaseRequest,
    ShelveRequest,
    TaskRequest,
    TimePassed,
    TransitionRequest,
    UnshelveRequest,
)
from domain.lifecycle import Transition
from domain.loosening import may_loosen
from domain.paths.path import Path
from domain.process_terms import ProcessAction, ProcessRequest
from tests.support.models import BASE

HELD = ["operator"]
RELEASE_STOP = EmergencyStopRequest(engaged=False, reason="")
LOOSENING = (
    TaskRequest(Path(np.array([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]])), 0, "stanley", 1.0),
    ModeRequest(BASE, "FAST"),
    ParametersRequest(BASE, {"max_speed": 0.1}),
    TransitionRequest(BASE, Transition.CONFIGURE),
    TransitionRequest(BASE, Transition.ACTIVATE),
    ReleaseRequest("operator"),
    AcknowledgeRequest(ESTOP),
    ShelveRequest(ESTOP, 1, "known"),
    ProcessRequest(BASE, ProcessAction.START),
    ProcessRequest(BASE, ProcessAction.RESTART),
    RELEASE_STOP,
)
SAFER = (
    TransitionRequest(BASE, Transition.DEACTIVATE),
    TransitionRequest(BASE, Transition.CLEANUP),
    TransitionRequest(BASE, Transition.SHUTDOWN),
    HoldRequest("operator", "lunch"),
    CancelTaskRequest(),
    ProcessRequest(BASE, ProcessAction.STOP),
    UnshelveRequest(ESTOP),
    CancelRequest(ChangeId("c1")),
    EmergencyStopRequest(engaged=True, reason="smoke"),
)


@pytest.mark.parametrize("given", LOOSENING)
def test_what_starts_or_loosens_is_known(given: Input) -> None:
    assert may_loosen(given, is_stopped=True, holds=HELD)


@pytest.mark.parametrize("given", SAFER)
def test_what_makes_safer_loosens_nothing(given: Input) -> None:
    assert not may_loosen(given, is_stopped=True, holds=HELD)


def test_a_release_of_what_is_released_loosens_nothing() -> None:
    assert not may_loosen(RELEASE_STOP, is_stopped=False, holds=HELD)
    assert not may_loosen(ReleaseRequest("planner"), is_stopped=True, holds=HELD)


def test_every_request_is_one_or_the_other() -> None:
    requests = {*get_args(ChangeRequest), *get_args(DriveRequest)}

    assert requests <= {type(given) for given in (*LOOSENING, *SAFER)}


def test_what_is_no_request_is_neither() -> None:
    with pytest.raises(TypeError, match="TimePassed"):
        may_loosen(TimePassed(), is_stopped=True, holds=HELD)
