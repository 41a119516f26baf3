"""Watches that the vehicle stands when it should, and tells when it does not.

A stop is commanded once, and speed 0 is all that can be commanded. Brakes that are soft or fail
need a person, who has to be told: an ESTOP that does not stop must not be silent.
"""

from dataclasses import dataclass

from domain.concern import Concern
from domain.events.driving import VehicleStandstillUnknown, VehicleStillMoving, VehicleStopped
from domain.findings import Blocker
from domain.health.emergency_stop import EmergencyStop
from domain.outbox import Outbox
from domain.snapshot import TaskStatus
from domain.tasks.driving import Driving
from domain.tasks.holds import ERROR_HOLD
from domain.timebase import Duration, Instant, seconds, to_seconds

STILL_MOVING = "STILL_MOVING"
STANDSTILL_UNKNOWN = "STANDSTILL_UNKNOWN"

REACTION: Duration = seconds(1.0)
"""Time that the vehicle may take besides braking: delay, and reports that come seldom."""
_DIGITS = 3


@dataclass(slots=True)
class _Stop:
    """A stop while it is watched."""

    since: Instant
    due: Instant
    """By then the vehicle has to stand."""
    backwards: bool
    """Direction in which the vehicle moved when it began."""
    cause: int | None
    """Id of the event that began it; None: the vehicle moved by itself."""
    found: Blocker | None = None
    """What was told; None: nothing yet."""


class Standstill(Concern):
    """Watches each stop until the vehicle stands or a task drives it again.

    The vehicle should stand after a task was held or ended, and after a hold was set; and as long
    as a task is held or the robot is in ERROR, which an emergency stop causes. Without any of
    these, something else may drive it.
    """

    def __init__(self, driving: Driving, emergency_stop: EmergencyStop, outbox: Outbox) -> None:
        """Begin without a stop.

        Args:
            driving: Its task, its holds and the motion of the vehicle.
            emergency_stop: Informed when the vehicle moves although it should stand.
            outbox: Receives events.
        """
        self._driving = driving
        self._watch = driving.watch
        self._emergency_stop = emergency_stop
        self._outbox = outbox
        self._was_driven = False
        self._holds = driving.holds
        self._stop: _Stop | None = None
        self._rolls_until: Instant = 0
        """Until then it must stand in any case: a task that ended may have moved a vehicle that did
        not report it yet, and one report of a standstill may be noise."""

    def wake_at(self) -> Instant | None:
        """Return by when the vehicle has to stand; None: no stop is watched, or it was told."""
        stop = self._stop
        return None if stop is None or stop.found is not None else stop.due

    def pass_time(self, now: Instant) -> None:
        """Tell that the vehicle does not stand in time."""
        stop, due = self._stop, self.wake_at()
        if stop is not None and due is not None and due <= now:
            self._tell(stop, now)

    def settle(self, now: Instant) -> bool:
        """Begin, judge and end the watch over a stop; return whether that told anything."""
        is_driven = self._driving.status is TaskStatus.RUNNING_TASK
        was_driven, self._was_driven = self._was_driven, is_driven
        is_newly_held = self._take_holds()
        if is_driven:
            return self._forget()
        if self._stop is None and self._watch.state is not None:
            self._stop = self._new_stop(now, was_driven=was_driven, is_newly_held=is_newly_held)
        return self._stop is not None and self._judge(self._stop, now)

    def _take_holds(self) -> bool:
        """Return whether a hold was set since the last call."""
        before, self._holds = self._holds, self._driving.holds
        return self._holds is not before and bool(self._holds.keys() - before.keys())

    def _new_stop(self, now: Instant, *, was_driven: bool, is_newly_held: bool) -> _Stop | None:
        """Return the stop that begins now, if any."""
        if was_driven:
            self._rolls_until = now + REACTION
        elif not self._watch.moves or not (is_newly_held or self._must_stand(now)):
            return None
        by_us = was_driven or is_newly_held
        cause = self._outbox.record_input() if by_us else None
        return _Stop(
            now, now + REACTION + self._watch.braking_time(), self._watch.is_backwards, cause
        )

    def _must_stand(self, now: Instant) -> bool:
        """Tell whether a vehicle that stood must not move again."""
        is_held = self._driving.status is TaskStatus.PAUSED_TASK or ERROR_HOLD in self._holds
        return is_held or now < self._rolls_until

    def _judge(self, stop: _Stop, now: Instant) -> bool:
        """End the watch once the vehicle stands; tell anew when its pose is lost or is back."""
        speed_mps = self._watch.speed_since(stop.since)
        # One that turned round stood in between: so the noise of a speed of 0 is no movement.
        stood = self._watch.stands or self._watch.is_backwards is not stop.backwards
        if speed_mps is not None and stood:
            return self._end(stop, now)
        if stop.found is None or stop.found.code == _code(speed_mps):
            return False
        self._tell(stop, now)
        return True

    def _end(self, stop: _Stop, now: Instant) -> bool:
        """End the watch of a vehicle that stood; return whether that told anything."""
        self._stop, self._rolls_until = None, now + REACTION
        if stop.found is None:
            return False
        self._watch.found(None)
        self._outbox.emit(VehicleStopped(_s_between(stop.since, now)))
        return True

    def _tell(self, stop: _Stop, now: Instant) -> None:
        speed_mps, after_s = self._watch.speed_since(stop.since), _s_between(stop.since, now)
        event: VehicleStillMoving | VehicleStandstillUnknown
        if speed_mps is None:
            event = VehicleStandstillUnknown(after_s)
        else:
            speed_mps = round(speed_mps, _DIGITS)
            event = VehicleStillMoving(speed_mps, after_s)
        limit_mps = self._watch.settings.standstill_mps
        stop.found = Blocker(
            code=_code(speed_mps),
            message=event.words,
            path=("vehicle",),
            value=speed_mps,
            threshold=limit_mps,
            since=stop.since,
            refuses=False,
        )
        self._watch.found(stop.found)
        self._emergency_stop.note_motion()
        self._outbox.emit(event, stop.cause)

    def _forget(self) -> bool:
        """End the watch since a task drives the vehicle; return whether something was told."""
        stop, self._stop = self._stop, None
        if stop is None or stop.found is None:
            return False
        self._watch.found(None)
        return True


def _code(speed_mps: float | None) -> str:
    return STANDSTILL_UNKNOWN if speed_mps is None else STILL_MOVING


def _s_between(since: Instant, now: Instant) -> float:
    return round(to_seconds(now - since), _DIGITS)
