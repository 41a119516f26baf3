"""The last reported state of the vehicle, whether it is stale, and the last command."""

import math

from domain.errors import InvalidValueError
from domain.findings import Blocker
from domain.inputs import VehicleReport
from domain.outbox import Outbox
from domain.snapshot import VehicleView
from domain.tasks.settings import TaskSettings
from domain.timebase import Duration, Instant, seconds
from domain.vehicle import DriveCommand, Point, VehicleState

SPARE = 1.25
"""A stop may take so many times as long as the assumed braking does."""

_LONGEST_S = 600.0
_AT_REST = DriveCommand(0.0, 0.0)


class VehicleWatch:
    """Keeps the newest report; a pose that was never reported counts as stale."""

    def __init__(self, settings: TaskSettings, outbox: Outbox) -> None:
        self.settings = settings
        self._outbox = outbox
        self._state: VehicleState | None = None
        self._at: Instant | None = None
        self._command = _AT_REST
        self._lookahead: Point | None = None
        self.is_lost = True
        """No report, or none within `pose_stale_after`."""
        self.still_moving: Blocker | None = None
        """See `VehicleView`; set by `Standstill`."""

    def check(self, report: VehicleReport) -> None:
        """Reject an invalid report.

        Raises:
            InvalidValueError: A number is not finite.
        """
        state = report.state
        pose = state.pose
        numbers = (pose.x_m, pose.y_m, pose.yaw_rad, state.speed_mps, state.steering_angle_rad)
        if not all(map(math.isfinite, numbers)):
            raise InvalidValueError("the vehicle reports a number that is not finite", "pose")

    def take(self, report: VehicleReport, now: Instant) -> None:
        """Hold a checked report."""
        if report.state != self._state:
            self._outbox.vehicle_changed = True
        self._state, self._at = report.state, now
        self.is_lost = False

    def told(self, command: DriveCommand, lookahead: Point | None) -> None:
        """Record the last command and the look-ahead point; None: no task is driving."""
        if command != self._command or lookahead != self._lookahead:
            self._command, self._lookahead = command, lookahead
            self._outbox.vehicle_changed = True

    def found(self, still_moving: Blocker | None) -> None:
        """Record whether the vehicle moves though it should stand; None: no such finding."""
        self.still_moving = still_moving
        self._outbox.vehicle_changed = True

    def stop_command(self) -> DriveCommand:
        """Return the command to stop with the current steering angle."""
        steering = 0.0 if self._state is None else self._state.steering_angle_rad
        return DriveCommand(0.0, steering)

    def fresh_state(self, now: Instant) -> VehicleState | None:
        """Return the newest state; None: there is none, or it is stale."""
        if self._at is None or now - self._at > self.settings.pose_stale_after:
            return None
        return self._state

    @property
    def state(self) -> VehicleState | None:
        """Return the newest state, however old; None: there is none."""
        return self._state

    @property
    def stands(self) -> bool:
        """Tell whether the vehicle is known to be at standstill."""
        if self._state is None or self.is_lost:
            return False
        return abs(self._state.speed_mps) < self.settings.standstill_mps

    @property
    def moves(self) -> bool:
        """Tell whether the vehicle moved when it was last heard."""
        if self._state is None:
            return False
        return abs(self._state.speed_mps) >= self.settings.standstill_mps

    @property
    def is_backwards(self) -> bool:
        """Tell whether the vehicle moved backwards when it was last heard."""
        return self._state is not None and self._state.speed_mps < 0.0

    def speed_since(self, since: Instant) -> float | None:
        """Return the present speed without its sign, in m/s.

        None: it is unknown, since there is no report after `since`, or none that is recent enough.
        """
        if self._state is None or self._at is None or self.is_lost or self._at <= since:
            return None
        return abs(self._state.speed_mps)

    def braking_time(self) -> Duration:
        """Return the time that a stop may take at the speed that was heard last."""
        speed_mps = 0.0 if self._state is None else abs(self._state.speed_mps)
        # Bounded, since a vehicle may report any speed, and the settings may have any braking.
        return seconds(min(SPARE * speed_mps / self.settings.braking_mps2, _LONGEST_S))

    def distance_to(self, point: Point) -> float | None:
        """Return the distance to a point, in m; None: the pose is unknown."""
        if self._state is None or self.is_lost:
            return None
        pose = self._state.pose
        return math.hypot(point.x_m - pose.x_m, point.y_m - pose.y_m)

    def wake_at(self) -> Instant | None:
        """Return when the pose becomes stale without a new report; None: it is already."""
        if self.is_lost or self._at is None:
            return None
        # "Older than" is strict, and time counts in integer nanoseconds.
        return self._at + self.settings.pose_stale_after + 1

    def pass_time(self, now: Instant) -> bool:
        """Return whether the pose became stale by now."""
        due = self.wake_at()
        if due is None or due > now:
            return False
        self.is_lost = True
        return True

    @property
    def view(self) -> VehicleView:
        """Return the view of the vehicle."""
        return VehicleView(self._state, self._at, self._command, self._lookahead, self.still_moving)
