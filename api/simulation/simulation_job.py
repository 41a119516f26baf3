"""Scenarios that a client posts; the functions here run in a worker process."""

import copyreg
import io
import pickle
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from types import MappingProxyType
from typing import Any, NamedTuple

from pydantic import ValidationError

from api.http.body_parsing import InvalidBodyError, faults_of, parse_json
from api.http.schemas.simulation import SimulationBody, place_in_body
from api.simulation.simulation import Simulation
from domain.errors import InvalidValueError
from domain.onboard import Onboard
from domain.simulation.robot import SimulatedRobot
from domain.timebase import Instant
from service.event_log import EventLog
from service.files.model_file import LoadedModel, read_model
from service.files.robot_file import RobotSettings, robot_settings_of
from service.onboard_parts import make_onboard
from service.simulation.from_settings import make_simulated_robot
from service.simulation.virtual_time import VirtualClock, VirtualService

EPOCH = "simulation"
BEGIN = datetime(2000, 1, 1, tzinfo=UTC)
"""What a calendar says at 0 s, so that two runs say the same."""


class SimulatedParts(NamedTuple):
    """A live robot of which nothing is real, so that a simulation can go on with a copy of it."""

    onboard: Onboard
    robot: SimulatedRobot


@dataclass(frozen=True, slots=True)
class LiveCopy:
    """The live robot at one moment, to go on from in virtual time."""

    state: bytes
    """Pickled supervision, navigation and simulated robot."""
    now: Instant
    wall: datetime
    events: int
    """Id of the last event."""


def copy_of(onboard: Onboard, robot: SimulatedRobot) -> bytes:
    """Return both as they are now; what happens to the copy does not happen to them."""
    copy = io.BytesIO()
    _Pickler(copy, pickle.HIGHEST_PROTOCOL).dump((onboard, robot))
    return copy.getvalue()


def _reduce_view(view: MappingProxyType[Any, Any]) -> tuple[Callable[..., Any], tuple[Any]]:
    return _view_of, (dict(view),)


def _view_of(values: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    # Needed since the type itself is known by no name under which it could be found.
    return MappingProxyType(values)


class _Pickler(pickle.Pickler):
    """Also takes read-only views of mappings, which the standard one does not."""

    dispatch_table: Mapping[type, Callable[[Any], Any]] = {
        **copyreg.dispatch_table,
        MappingProxyType: _reduce_view,
    }


def simulate_posted(raw: bytes, model_text: str, live: LiveCopy | None) -> bytes:
    """Return what comes of a posted scenario, as JSON.

    Args:
        raw: The body, as `SimulationBody` describes it.
        model_text: The loaded model.
        live: A copy of the live robot; None: it is not to be had.

    Raises:
        PilothouseError: The body is invalid, or too much would happen.
    """
    body = _read(raw)
    simulation = Simulation(body, robot_for(body, model_text, live))
    simulation.run()
    return simulation.as_json().encode()


def _read(raw: bytes) -> SimulationBody:
    try:
        return SimulationBody.model_validate(parse_json(raw))
    except ValidationError as error:
        faults = error.errors(include_url=False)
        placed = ({**fault, "loc": place_in_body(fault["loc"])} for fault in faults)
        raise InvalidBodyError(faults_of(placed)) from error


def robot_for(body: SimulationBody, model_text: str, live: LiveCopy | None) -> VirtualService:
    """Return the robot that a scenario begins with.

    Raises:
        InvalidBodyError: Its settings are wrong, or it cannot be a copy of the live robot.
        InvalidModelError: Its model is.
    """
    if body.begin == "live":
        if live is None:
            error = InvalidValueError("the live robot is not simulated: it cannot be copied yet")
            raise InvalidBodyError.at("from", error)
        return _copied(model_text, live)
    loaded = read_model(model_text if body.model is None else body.model)
    try:
        robot = robot_settings_of(body.robot or {}, loaded.model)
    except InvalidValueError as error:
        raise InvalidBodyError.at(f"/robot{error.pointer}", error) from error
    return _new(loaded, robot)


def _new(loaded: LoadedModel, robot: RobotSettings) -> VirtualService:
    mock = robot.mock is True
    return VirtualService(
        loaded,
        make_onboard(loaded.model, robot, 0),
        make_simulated_robot(loaded.model, robot, 0, mock=mock),
        VirtualClock(0, BEGIN),
        EventLog(epoch=EPOCH),
    )


def _copied(model_text: str, live: LiveCopy) -> VirtualService:
    onboard, robot = pickle.loads(live.state)
    return VirtualService(
        read_model(model_text),
        onboard,
        robot,
        VirtualClock(live.now, live.wall),
        EventLog(epoch=EPOCH, before=live.events),
    )
