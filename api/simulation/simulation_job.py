"""Posted scenarios; `simulate_posted` runs in a worker process."""

import io
import pickle
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import NamedTuple

from pydantic import ValidationError

from api.http.body_parsing import InvalidBodyError, faults_of, parse_json, pointer_to
from api.http.schemas.problem import BodyFault
from api.http.schemas.simulation import ConditionStep, SimulationBody, place_in_body
from api.simulation.simulation import Simulation
from domain.conditions.check import check
from domain.conditions.condition import Condition
from domain.errors import InvalidValueError
from domain.onboard import Onboard
from domain.parts.system_model import SmhModel
from domain.robot_vocabulary import vocabulary_of
from domain.simulation.robot import SimulatedRobot
from domain.timebase import Instant
from service.checkpoint import CorePickler
from service.event_log import EventLog
from service.files.model_file import LoadedModel, read_model, with_signals
from service.files.robot_file import RobotSettings, robot_settings_of
from service.onboard_parts import make_onboard
from service.simulation.from_settings import make_simulated_robot
from service.simulation.virtual_time import VirtualService
from service.virtual_clock import VirtualClock

EPOCH = "simulation"
BEGIN = datetime(2000, 1, 1, tzinfo=UTC)
"""Wall time at 0 s; fixed, so that all runs are equal."""
IS_REAL = "the live robot is real: only a simulated one can be copied"
HAS_DEVICES = (
    "the live robot has several computers, and what runs on the others cannot be copied: leave out"
    " `from`, and give model and robot; all parts are then simulated as on one computer"
)


class SimulatedParts(NamedTuple):
    """A live robot that is completely simulated, so that a simulation can copy it."""

    onboard: Onboard
    robot: SimulatedRobot


@dataclass(frozen=True, slots=True)
class LiveCopy:
    """The live robot at one instant, for a simulation that continues from there."""

    state: bytes
    """Pickled supervision, navigation and simulated robot."""
    now: Instant
    wall: datetime
    events: int
    """Id of the last event."""


def copy_of(onboard: Onboard, robot: SimulatedRobot) -> bytes:
    """Return a pickled copy of both in their current state."""
    copy = io.BytesIO()
    CorePickler(copy, pickle.HIGHEST_PROTOCOL).dump((onboard, robot))
    return copy.getvalue()


def simulate_posted(
    raw: bytes, model_text: str, live: LiveCopy | None, why_not: str = IS_REAL
) -> bytes:
    """Run a posted scenario and return the results as JSON.

    Args:
        raw: The body, as described by `SimulationBody`.
        model_text: The loaded model.
        live: A copy of the live robot; None: not available.
        why_not: Why it is not.

    Raises:
        PilothouseError: The body is invalid, or the results are too large.
    """
    body = _read(raw)
    simulation = Simulation(body, robot_for(body, model_text, live, why_not))
    simulation.run()
    return simulation.as_json().encode()


def _read(raw: bytes) -> SimulationBody:
    try:
        return SimulationBody.model_validate(parse_json(raw))
    except ValidationError as error:
        faults = error.errors(include_url=False)
        placed = ({**fault, "loc": place_in_body(fault["loc"])} for fault in faults)
        raise InvalidBodyError(faults_of(placed), count=error.error_count()) from error


def robot_for(
    body: SimulationBody, model_text: str, live: LiveCopy | None, why_not: str = IS_REAL
) -> VirtualService:
    """Return the robot at the start of a scenario.

    Args:
        body: The scenario.
        model_text: The loaded model, for a scenario without one.
        live: A copy of the live robot; None: not available.
        why_not: Why it is not.

    Raises:
        InvalidBodyError: The settings are invalid, or the live robot cannot be copied.
        InvalidModelError: The model is invalid.
    """
    if body.begin == "live":
        if live is None:
            raise InvalidBodyError.at("from", InvalidValueError(why_not))
        return _copied(model_text, live)
    loaded = read_model(model_text if body.model is None else body.model)
    try:
        robot = robot_settings_of(body.robot or {}, loaded.model)
    except InvalidValueError as error:
        raise InvalidBodyError.at(f"/robot{error.pointer}", error) from error
    # One computer simulates all parts, and decides what devices would.
    robot = robot.model_copy(update={"devices": {}})
    if body.robot is not None:
        loaded = with_signals(loaded, robot.to_signal_settings())
    if faults := list(_faults_of_conditions(body, loaded.model, robot)):
        raise InvalidBodyError(faults)
    return _new(loaded, robot)


def _faults_of_conditions(
    body: SimulationBody, model: SmhModel, robot: RobotSettings
) -> Iterator[BodyFault]:
    """Yield what is wrong in the conditions that a scenario expects of its robot."""
    vocabulary = None
    for index, step in enumerate(body.steps):
        if not isinstance(step, ConditionStep):
            continue
        if vocabulary is None:
            vocabulary = vocabulary_of(model, robot.to_signal_settings(), is_complete=True)
        for fault in check(Condition.parse(step.expect), vocabulary):
            if fault.severity == "error":
                yield BodyFault(
                    pointer=pointer_to("steps", index, "expect"),
                    code=fault.code,
                    message=f"column {fault.column}: {fault.message}",
                )


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
