"""The topics on which smart_polaris receives its five signals; each has its own type."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from datetime import timedelta
from functools import partial
from typing import Any

from domain.actor import Actor
from domain.errors import InvalidValueError
from domain.inputs import Reading, SignalValue
from domain.timebase import Instant
from service.clock import EPOCH, Clock
from service.ros.interface.endpoints import Fields, SubscribedTopic
from service.ros.interface.message_check import HEADER, Kind, Shape, checked
from service.supervisor import Supervisor

_STRENGTHS = ("NOT_CONNECTED", "CONNECTED", "LOW_SIGNAL")
"""In the order of the constants in SignalStrengthStamped.msg of smart_polaris."""


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
    field: str
    kind: Kind
    read: Callable[[Any], SignalValue] = _as_it_is

    @property
    def shape(self) -> Shape:
        return {"header": HEADER, self.field: self.kind}


_INPUTS = (
    _Input("battery_level", "BatteryLevelStamped", "battery_level", Kind.NUMBER),
    _Input("estop", "EstopStamped", "enabled", Kind.BOOLEAN),
    _Input("gps_accuracy", "GpsAccuracyStamped", "accuracy", Kind.NUMBER),
    _Input("signal_strength", "SignalStrengthStamped", "strength", Kind.UINT8, _strength),
    _Input("temperature", "TemperatureStamped", "temperature", Kind.NUMBER),
)


def reading_topics(supervisor: Supervisor) -> Iterable[SubscribedTopic]:
    """Return the topics whose messages become readings."""
    return tuple(
        SubscribedTopic(
            name=f"/{given.signal}",
            type=f"gem_state_msgs/msg/{given.type}",
            take=partial(_take, supervisor, given),
        )
        for given in _INPUTS
    )


def _take(supervisor: Supervisor, given: _Input, fields: Fields, sender: Actor) -> None:
    """Submit a reading.

    Raises:
        PilothouseError: It is rejected. A message without the value is rejected although ROS has a
            default for it: an empty message would release an e-stop.
    """
    message = checked(given.shape, fields)
    if given.field not in fields:
        raise InvalidValueError(f"{given.field} is missing", given.field)
    stamp = _stamp(supervisor.clock, message["header"]["stamp"])
    reading = Reading(given.signal, given.read(message[given.field]), stamp)
    supervisor.readings.submit([reading], source=sender.label, actor=sender)


def _stamp(clock: Clock, stamp: Mapping[str, int]) -> Instant | None:
    """Return the time stamp of a message on our clock; None: it is 0, so it was not set."""
    if not stamp["sec"] and not stamp["nanosec"]:
        return None
    since = timedelta(seconds=stamp["sec"], microseconds=stamp["nanosec"] // 1_000)
    return clock.from_wall(EPOCH + since)
