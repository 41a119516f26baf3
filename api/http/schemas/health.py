"""Signals, the system state, the emergency stop and the mock as clients see them."""

from collections.abc import Sequence
from datetime import datetime
from typing import Annotated

from pydantic import Field

from api.http.schemas.base import BlockerJson, Body, Json, Timestamp, timestamp, timestamp_or_none
from api.http.schemas.problem import WithIgnored
from api.http.schemas.sent_values import SentSignalValue
from domain.computers import StopView
from domain.errors import InvalidValueError
from domain.findings import Fact
from domain.health.signals import signal_name
from domain.inputs import Reading, SignalValue
from domain.snapshot import (
    EmergencyStopView,
    SignalView,
    SystemState,
    SystemStateView,
    TaskStatus,
)
from domain.timebase import Instant, to_seconds
from service.clock import Clock

MAX_SOURCE = 64
"""Largest length of the name of a source, in characters."""

MAX_REASON = 500
"""Largest length of the reason of an emergency stop, in characters."""

MAX_STOPS = 1_000
"""Largest number of stops that one request releases."""

MAX_STOP_ID = 100
"""Largest length of the id of a stop, in characters."""


class PendingJson(Json):
    """An error that will be raised if the signal stays bad."""

    error: str
    since_at: Timestamp
    needs_s: float


class AgedPendingJson(PendingJson):
    """An error that will be raised if the signal stays bad, and how long that has counted."""

    for_s: float


class StreamedSignalJson(Json):
    """One signal as in frames: without ages, which clients compute from the times."""

    signal: str
    value: SignalValue | None = Field(description="null: never seen")
    unit: str
    source: str | None
    received_at: Timestamp | None
    stamp_at: Timestamp | None = Field(description="Time of measurement, by the sender's clock")
    skewed: bool = Field(description="The sender's clock differs from ours by more than 1 s")
    stale: bool
    error: str | None
    source_fault: str | None = Field(
        description="Why its source gives no reading; null: it does, or the signal has none"
    )
    needs_acknowledgement: bool = Field(
        description="`error` ends only after an operator has acknowledged it, and nobody has yet"
    )
    pending: PendingJson | None
    settings: dict[str, Fact]

    @classmethod
    def of(cls, view: SignalView, clock: Clock) -> "StreamedSignalJson":
        """Show `view`."""
        return cls(
            signal=view.signal,
            value=view.value,
            unit=view.unit,
            source=view.source,
            received_at=timestamp_or_none(clock, view.received_at),
            stamp_at=timestamp_or_none(clock, view.stamp),
            skewed=view.skewed,
            stale=view.stale,
            error=view.error,
            source_fault=view.source_fault,
            needs_acknowledgement=view.needs_acknowledgement,
            pending=_pending(view, clock),
            settings=dict(view.settings),
        )


class SignalJson(StreamedSignalJson):
    """One signal: the value held, and its evaluation."""

    age_s: float | None
    pending: AgedPendingJson | None

    @classmethod
    def at(cls, view: SignalView, clock: Clock, now: Instant) -> "SignalJson":
        """Show `view` as it is at `now`."""
        streamed = dict(StreamedSignalJson.of(view, clock))
        pending = streamed.pop("pending")
        since = view.pending_since
        return cls(
            **streamed,
            age_s=None if view.received_at is None else to_seconds(now - view.received_at),
            pending=(
                None
                if pending is None or since is None
                else AgedPendingJson(**dict(pending), for_s=to_seconds(now - since))
            ),
        )


def _pending(view: SignalView, clock: Clock) -> PendingJson | None:
    if view.pending_error is None or view.pending_since is None or view.pending_needs is None:
        return None
    return PendingJson(
        error=view.pending_error,
        since_at=timestamp(clock, view.pending_since),
        needs_s=to_seconds(view.pending_needs),
    )


class SignalsJson(Json):
    """All signals."""

    items: list[SignalJson]


class SystemStateJson(Json):
    """State of the robot with its reasons; error code and state always match."""

    seq: int = Field(description="Number of the newest frame")
    at: Timestamp
    state: SystemState
    error_code: int = Field(description="Bit mask; 0 means no error")
    errors: tuple[str, ...]
    reasons: list[BlockerJson]
    task_status: TaskStatus
    simulated: tuple[str, ...] = Field(description="Parts of the robot that are simulated")
    storage_fault: str | None = Field(
        description="Why what happens is not stored, so that a restart may forget it; null: it is"
    )

    @classmethod
    def of(
        cls,
        view: SystemStateView,
        seq: int,
        at: Instant,
        simulated: Sequence[str],
        clock: Clock,
    ) -> "SystemStateJson":
        """Show `view`.

        Args:
            view: State of the robot.
            seq: Number of the newest frame at `at`.
            at: Time of the view.
            simulated: Parts of the robot that are simulated.
            clock: Converts times.
        """
        return cls(
            seq=seq,
            at=timestamp(clock, at),
            state=view.state,
            error_code=view.error_code,
            errors=view.errors,
            reasons=[BlockerJson.of(reason, clock) for reason in view.reasons],
            task_status=view.task_status,
            simulated=tuple(simulated),
            storage_fault=view.storage_fault,
        )


class TakenReadingsJson(SystemStateJson, WithIgnored):
    """The system state that follows from readings."""


class EngagedStopJson(Json):
    """One emergency stop that is engaged."""

    id: str = Field(description="Never used twice; a release names it")
    device: str | None = Field(
        description="Computer on which it is engaged, `supervisor` or a device; null: this one"
    )
    by: str
    reason: str
    since_at: Timestamp

    @classmethod
    def of(cls, view: StopView, clock: Clock) -> "EngagedStopJson":
        """Show `view`."""
        return cls(
            id=view.id,
            device=view.computer,
            by=view.by,
            reason=view.reason,
            since_at=timestamp(clock, view.since),
        )


class EmergencyStopJson(Json):
    """The latch that only a person releases: engaged while a stop is, on any computer."""

    engaged: bool
    by: str | None
    reason: str | None
    since_at: Timestamp | None
    standstill_at: Timestamp | None
    stops: list[EngagedStopJson] = Field(
        description="All that are engaged, the oldest first: `by`, `reason` and `since_at` are its"
    )
    waits_for: tuple[str, ...] = Field(
        description="Computers that were asked to release a stop, and did not say yet that they did"
    )
    not_heard: tuple[str, ...] = Field(
        description="While it is engaged, computers that cannot be heard: they are not known to be"
        " stopped, and their own stops stay engaged"
    )

    @classmethod
    def of(cls, view: EmergencyStopView, clock: Clock) -> "EmergencyStopJson":
        """Show `view`."""
        return cls(
            engaged=view.engaged,
            by=view.by,
            reason=view.reason,
            since_at=timestamp_or_none(clock, view.since),
            standstill_at=timestamp_or_none(clock, view.standstill_at),
            stops=[EngagedStopJson.of(stop, clock) for stop in view.stops],
            waits_for=view.waits_for,
            not_heard=view.not_heard,
        )


class EmergencyStopAnswerJson(EmergencyStopJson, WithIgnored):
    """The latch after a request."""


class MockSignalJson(Json):
    """One signal of the mock."""

    signal: str
    value: SignalValue
    publishing: bool


class MockJson(Json):
    """All signals of the mock."""

    items: list[MockSignalJson]


class ReadingBody(Body):
    """One reading of one signal."""

    value: SentSignalValue
    stamp: str | None = Field(
        default=None,
        max_length=64,
        description="Time of measurement: RFC 3339 with an offset, such as `...+01:00` or `...Z`",
    )
    source: str | None = Field(
        default=None,
        min_length=1,
        max_length=MAX_SOURCE,
        description=(
            "Who measured; one source of `estop` cannot release another. Default: `api`, or `mock`"
            " while the mock runs"
        ),
    )

    def reading(self, signal: str, clock: Clock) -> Reading:
        """Return the reading that was sent.

        Raises:
            InvalidValueError: The stamp is not a time with an offset.
        """
        stamp = None if self.stamp is None else read_stamp(self.stamp, clock)
        return Reading(signal_name(signal), self.value, stamp)


def read_stamp(text: str, clock: Clock) -> Instant:
    """Return a time in RFC 3339 as an instant of `clock`.

    Raises:
        InvalidValueError: It is not a time, or has no offset.
    """
    try:
        return clock.from_wall(datetime.fromisoformat(text))
    except ValueError as error:
        message = f"invalid time {text!r}; expected a time such as 2026-05-04T12:00:00.250Z"
        raise InvalidValueError(message, "/stamp") from error
    except InvalidValueError as error:
        raise InvalidValueError(error.message, "/stamp") from error


class EmergencyStopBody(Body):
    """Engage or release the emergency stop."""

    engaged: bool
    reason: str | None = Field(default=None, max_length=MAX_REASON)
    volatile: bool = Field(
        default=False,
        description="Release it though storage fails; a restart of the service may forget that",
    )
    stops: list[Annotated[str, Field(max_length=MAX_STOP_ID)]] | None = Field(
        default=None,
        max_length=MAX_STOPS,
        description="Ids of the stops that are released, which somebody saw; any other stays"
        " engaged. Omitted: all that are known",
    )


class MockBody(Body):
    """Set the value of a mock signal, or stop or resume publishing it."""

    value: SentSignalValue | None = None
    publishing: bool | None = None
