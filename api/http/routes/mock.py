"""The mock signals. 404 if the mock is not running."""

from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Path

from api.http.body_parsing import InvalidBodyError
from api.http.dependencies import ActorDep, SupervisorDep
from api.http.problems import HttpError
from api.http.route_policy import Permission, policy
from api.http.schemas.health import MockBody, MockJson, MockSignalJson
from api.http.schemas.sent_values import SentSignalName
from api.http.stop_route import StopRoute
from domain.errors import InvalidValueError, UnknownSignalError
from domain.inputs import Reading, Readings
from service.readings import UNNAMED, Mock
from service.supervisor import Supervisor

router = APIRouter(prefix="/mock", tags=["health"], route_class=StopRoute)


@router.get("")
@policy(Permission.OBSERVE)
async def get_mock(supervisor: SupervisorDep) -> MockJson:
    """Show the values of the mock signals, and which are published."""
    return MockJson(items=_signals(_mock_of(supervisor)))


@router.patch("/{signal:path}")
@policy(Permission.OPERATE)
async def change_mock(
    signal: Annotated[SentSignalName, Path(description="One of those in `GET /mock`")],
    body: MockBody,
    supervisor: SupervisorDep,
    actor: ActorDep,
) -> MockSignalJson:
    """Set the value of a mock signal, or stop or resume publishing it; both or none are done.

    The mock stands in for no device: a signal that one reads is 409 `ACTS_ELSEWHERE`, except an
    `estop` that asks for a stop.
    """
    mock = _mock_of(supervisor)
    if not mock.holds(signal):
        known = [item.signal for item in mock.view()]
        raise UnknownSignalError("signal of the mock", signal, known)
    if body.publishing:
        _require_own(supervisor, mock, signal)
    try:
        if body.value is not None:
            supervisor.readings.submit([Reading(signal, body.value)], actor=actor)
    except InvalidValueError as error:
        raise InvalidBodyError.at("value", error) from error
    if body.publishing is not None:
        mock.set_publishing(signal, body.publishing)
    return next(item for item in _signals(mock) if item.signal == signal)


def _require_own(supervisor: Supervisor, mock: Mock, signal: str) -> None:
    """Check that the mock may publish a signal.

    Raises:
        ActsElsewhereError: A device reads it.
    """
    value = next(item.value for item in mock.view() if item.signal == signal)
    supervisor.core.check_said_here(Readings((Reading(signal, value),), UNNAMED))


def _mock_of(supervisor: Supervisor) -> Mock:
    mock = supervisor.readings.mock
    if mock is None:
        detail = "the mock is not running: signals come from outside"
        hint = "start the service with --mock-signals, or with `mock: true` in the robot file"
        raise HttpError(HTTPStatus.NOT_FOUND, "NO_MOCK", detail, hint)
    return mock


def _signals(mock: Mock) -> list[MockSignalJson]:
    return [
        MockSignalJson(signal=item.signal, value=item.value, publishing=item.publishing)
        for item in mock.view()
    ]
