"""The topics of the five signals, as in smart_polaris; each has its own type."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from datetime import timedelta
from functools import partial
from typing import Any

from domain.actor import Actor
from domain.errors import InvalidValueError, PilothouseError
from domain.health.signals import ESTOP_SIGNAL, asks_for_stop
from domain.inputs import Reading, SignalValue
from domain.timebase import Instant
from service.clock import EPOCH, Clock
from service.ros.interface.endpoints import Fields, SubscribedTopic
from service.ros.interface.message_check import HEADER, Kind, checked
from service.ros.interface.message_sets import MessageSet, type_in
from service.supervisor import Supervisor

_STRENGTHS = ("NOT_CONNECTED", "CONNECTED", "LOW_SIGNAL")
"""In the order of the constants in SignalStrength.msg, which are those of smart_polaris."""


STOP_FIELDS = ("enabled", "data", "value")
"""Fields that ask for a stop: of smart_polaris, of std_msgs, and of our own interface. Only the
first releases it."""


def _as_it_is(value: SignalValue) -> SignalValue:
    return value


def _strength(number: int) -> SignalValue:
    if number >= len(_STRENGTHS):
        known = ", ".join(f"{index} {name}" for index, name in enumerate(_STRENGTHS))
        raise InvalidValueError(f"strength must be one of {known}, not {number}", "strength")
    return _STRENGTHS[number]


@dataclass(frozen=True, slots=True)
class _Input:
    """A topic, and the field that holds the value of a signal."""

    signal: str
    type: str
    """As in our own package."""
    field: str
    kind: Kind
    read: Callable[[Any], SignalValue] = _as_it_is


_INPUTS = (
    _Input("battery_level", "BatteryLevel", "battery_level", Kind.NUMBER),
    _Input("estop", "EmergencyStop", "enabled", Kind.BOOLEAN),
    _Input("gps_accuracy", "GpsAccuracy", "accuracy", Kind.NUMBER),
    _Input("signal_strength", "SignalStrength", "strength", Kind.UINT8, _strength),
    _Input("temperature", "Temperature", "temperature", Kind.NUMBER),
)


def reading_topics(supervisor: Supervisor, messages: MessageSet) -> Iterable[SubscribedTopic]:
    """Return the topics whose messages become readings, with the types of a package."""
    return tuple(
        SubscribedTopic(
            name=f"/{given.signal}",
            type=type_in(messages, given.type),
            take=partial(_take, supervisor, given),
        )
        for given in _INPUTS
    )


def _take(supervisor: Supervisor, given: _Input, fields: Fields, sender: Actor) -> str | None:
    """Submit a reading; return what was ignored of one that asks for a stop.

    Raises:
        PilothouseError: It is rejected.
    """
    try:
        if given.signal == ESTOP_SIGNAL and asks_for_stop_by_fields(fields):
            return _stop(supervisor, given, fields, sender)
        reading = _reading(supervisor.clock, given, fields)
        supervisor.readings.submit([reading], source=sender.label, actor=sender)
    except PilothouseError as error:
        supervisor.refused_readings.note(sender, f"{given.signal}: {error.message}")
        raise
    return None


def asks_for_stop_by_fields(fields: Fields) -> bool:
    """Tell whether a message on the topic of the e-stop asks for a stop, in whatever it is."""
    waiting: list[object] = [fields]
    while waiting:
        found = waiting.pop()
        if isinstance(found, Mapping):
            if any(asks_for_stop(found.get(name)) for name in STOP_FIELDS):
                return True
            waiting += found.values()
        elif isinstance(found, list):
            waiting += found
    return False


def _stop(supervisor: Supervisor, given: _Input, fields: Fields, sender: Actor) -> str | None:
    """Press the stop whatever else is in the message; return what was ignored of it."""
    stamp, ignored = None, None
    try:
        stamp = _stamp(supervisor.clock, fields.get("header"))
        _value(given, fields)
    except PilothouseError as error:
        ignored = error.message
    reading = Reading(given.signal, True, stamp)
    supervisor.readings.submit([reading], source=sender.label, actor=sender)
    if ignored is not None:
        supervisor.refused_readings.note_ignored(sender, ignored)
    return ignored


def _reading(clock: Clock, given: _Input, fields: Fields) -> Reading:
    """Return the reading in a message.

    Raises:
        InvalidValueError: The message is invalid.
    """
    value = _value(given, fields)
    return Reading(given.signal, value, _stamp(clock, fields.get("header")))


def _value(given: _Input, fields: Fields) -> SignalValue:
    """Return the value in a message.

    Raises:
        InvalidValueError: It is invalid, or there are unknown fields. A message without the value
            is rejected although ROS has a default for it: an empty message would release an e-stop.
    """
    own = {name: value for name, value in fields.items() if name != "header"}
    message = checked({given.field: given.kind}, own)
    if given.field not in fields:
        raise InvalidValueError(f"{given.field} is missing", given.field)
    return given.read(message[given.field])


def _stamp(clock: Clock, header: object) -> Instant | None:
    """Return the time stamp of a header on our clock; None: it is null or 0, so it was not set.

    Raises:
        InvalidValueError: The header is invalid.
    """
    if header is None:
        return None
    stamp = checked(HEADER, _without_nulls(header), "header")["stamp"]
    sec, nanosec = stamp["sec"] or stamp["secs"], stamp["nanosec"] or stamp["nsecs"]
    if not sec and not nanosec:
        return None
    return clock.from_wall(EPOCH + timedelta(seconds=sec, microseconds=nanosec // 1_000))


def _without_nulls(fields: object) -> object:
    """Leave out null, which clients send for what they do not know."""
    if not isinstance(fields, Mapping):
        return fields
    known = {name: value for name, value in fields.items() if value is not None}
    return {name: _without_nulls(value) for name, value in known.items()}
