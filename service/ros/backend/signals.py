"""Signals of the robot from ROS topics, as configured in the robot file."""

import logging
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from domain.arrays import np
from domain.errors import InvalidValueError
from domain.health.signals import SignalKind, SignalSpec
from domain.inputs import Reading, Readings, SignalValue
from domain.timebase import NANOSECONDS_PER_SECOND, Duration, Instant, seconds
from service.clock import Clock, to_datetime
from service.files.robot_file import RobotSettings
from service.files.ros2_block import SignalTopicBlock
from service.ros.graph.graph import Lane, Message, Qos, RosGraph

log = logging.getLogger(__name__)

NODE = "pilothouse_signals"

_PERIOD: Duration = seconds(0.02)
"""Least period of readings; a topic that is faster is thinned out."""
_BURST: Duration = seconds(0.2)
"""After a pause, readings for this duration may come at once."""
_QUIET: Duration = seconds(60)
"""Faults of a topic are logged no more often than this."""
_COVARIANCE_UNKNOWN = 0
_EAST, _NORTH = 0, 4
"""Indices of the variances in the 3 by 3 matrix."""


class SignalTopics:
    """Reads each signal that has a topic in the robot file.

    A publisher must repeat its value before the signal becomes stale. Invalid values are rejected,
    and messages without a measurement (a receiver without a fix) are ignored: the signal becomes
    stale if no valid one follows.
    """

    def __init__(self, robot: RobotSettings, graph: RosGraph, clock: Clock) -> None:
        specs = {signal.spec.name: signal.spec for signal in robot.to_signal_settings()}
        self._sources = [
            _Source(specs[name], topic, clock) for name, topic in robot.ros2.signals.items()
        ]
        self._graph = graph
        self._clock = clock

    def start(self, deliver: Callable[[Readings], None]) -> None:
        """Subscribe, and deliver readings while the graph is open.

        Raises:
            UnknownTypeError: The type of a topic is not installed.
        """
        if not self._sources:
            return
        node = self._graph.node(NODE, Lane.SENSORS)
        for source in self._sources:
            topic = source.topic
            take = partial(self._take, source, deliver)
            node.subscribe(topic.topic, topic.type, Qos.SENSOR, source.pick, take)

    def _take(
        self, source: "_Source", deliver: Callable[[Readings], None], sample: "_Sample"
    ) -> None:
        stamp = None
        if sample.stamp_ns is not None:
            stamp = self._clock.from_wall(to_datetime(sample.stamp_ns))
        reading = Reading(source.spec.name, sample.value, stamp)
        deliver(Readings((reading,), source=f"ros:{source.topic.topic}"))


@dataclass(frozen=True, slots=True)
class _Sample:
    """The reading in one message."""

    value: SignalValue
    stamp_ns: int | None
    """Since 1970-01-01 UTC; None: the message has no time stamp."""


class _Source:
    """Reads a signal from the messages of one topic; `pick` runs on the thread of ROS."""

    def __init__(self, spec: SignalSpec, topic: SignalTopicBlock, clock: Clock) -> None:
        self.spec = spec
        self.topic = topic
        self._path = topic.path
        self._clock = clock
        self._last: SignalValue | None = None
        self._spent_until: Instant = clock.now() - _BURST
        """Until then no further readings are allowed; in the past: some are."""
        self._quiet_until: Instant = 0

    def pick(self, message: Message) -> _Sample | None:
        """Return the reading in a message; None: there is none, or they come too fast."""
        try:
            value = self._value(message)
        except (AttributeError, IndexError, TypeError) as error:
            self._complain(f"no such field: {error}")
            return None
        if value is None or not self._is_wanted(value):
            return None
        return _Sample(value, _stamp_ns(message))

    def _value(self, message: Message) -> SignalValue | None:
        """Return the value of the signal; None: it was not measured.

        An invalid value is returned too: the service rejects, logs and counts it, as those that
        come in another way.
        """
        value: Any = _accuracy_mm(message) if self._path is None else _found(message, self._path)
        if self.spec.kind is SignalKind.BOOLEAN and self.topic.invert:
            # Of what is neither true nor false nobody knows the opposite.
            value = not value if isinstance(value, bool) else f"{value!r:.40}, inverted"
        if self.spec.kind is SignalKind.NUMBER and _is_number(value):
            value = value * self.topic.scale + self.topic.offset
            if not math.isfinite(value):
                return None
        try:
            return self.spec.checked(value)
        except InvalidValueError:
            return value if isinstance(value, bool | int | float | str) else f"{value!r:.40}"

    def _is_wanted(self, value: SignalValue) -> bool:
        """Tell whether a reading is passed on; a change of a non-numeric value always is."""
        changed = self.spec.kind is not SignalKind.NUMBER and value != self._last
        now = self._clock.now()
        spent_until = max(self._spent_until, now - _BURST)
        in_time = spent_until <= now
        if in_time:
            self._spent_until = spent_until + _PERIOD
        if changed or in_time:
            self._last = value
        return changed or in_time

    def _complain(self, words: str) -> None:
        now = self._clock.now()
        if now >= self._quiet_until:
            self._quiet_until = now + _QUIET
            where = f"{self.topic.topic} ({self.topic.type})"
            log.warning("%s is not accepted as %s: %s", where, self.spec.name, words)


def _found(message: Message, path: tuple[str | int, ...]) -> Any:  # noqa: ANN401  # a field of ROS
    """Return a field of a message as a plain Python value."""
    found = message
    for step in path:
        found = found[step] if isinstance(step, int) else getattr(found, step)
    if isinstance(found, np.generic):
        return found.item()
    # ROS returns a field of type `byte` as bytes of length 1.
    return found[0] if isinstance(found, bytes) and len(found) == 1 else found


def _accuracy_mm(fix: Message) -> float:
    """Return the standard deviation of the horizontal position, mm; NaN: unknown.

    Source: sensor_msgs, `NavSatFix.msg`.
    """
    if fix.status.status < 0 or fix.position_covariance_type == _COVARIANCE_UNKNOWN:
        return math.nan
    covariance = fix.position_covariance
    variance = float(covariance[_EAST]) + float(covariance[_NORTH])
    return 1_000 * math.sqrt(variance) if variance >= 0 else math.nan


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _stamp_ns(message: Message) -> int | None:
    """Return the time stamp of a message; None: it has none, or it is 0."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    sec, nanosec = getattr(stamp, "sec", 0), getattr(stamp, "nanosec", 0)
    return (sec * NANOSECONDS_PER_SECOND + nanosec) or None
