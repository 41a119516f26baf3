"""A simulated vehicle: a kinematic bicycle with limits, lag, delay and noise.

Deterministic and advanced like the core: the same commands at the same times lead to the same
reports, whether time advances in one step or in many.

Source: kinematic single-track model (KS) of M. Althoff, M. Koschi, S. Manzinger, "CommonRoad:
Composable Benchmarks for Motion Planning on Roads", IEEE Intelligent Vehicles Symposium 2017.
"""

import math
from collections import deque
from dataclasses import replace

from domain.arrays import np
from domain.inputs import VehicleReport
from domain.simulation.vehicle_settings import (
    WEAK_BRAKING_MPS2,
    Noise,
    Plant,
    VehicleFault,
    VehicleSettings,
)
from domain.timebase import Duration, Instant, seconds, to_seconds
from domain.vehicle import COMMAND_VALID_FOR, DriveCommand, Pose, VehicleState

REPORT_PERIOD: Duration = seconds(0.05)

_STEP: Duration = seconds(0.01)
_WEAK_BRAKES = VehicleFault.WEAK_BRAKES
_AS_GOOD_AS_THERE = 1e-6
"""Difference, in m/s or rad, at which a lag counts as settled; it would never reach its target."""


class SimulatedVehicle:
    """One vehicle; its reference point is the centre of the rear axle.

    It reports its state at 20 Hz from `start` on. A command takes effect after the delay of the
    plant and expires 0.5 s later; then the vehicle brakes and keeps its steering angle. `now` must
    never decrease from call to call.
    """

    def __init__(
        self, settings: VehicleSettings, start: Instant, at_first: VehicleState | None = None
    ) -> None:
        """Begin at standstill.

        Args:
            settings: Pose, limits and plant.
            start: The current time.
            at_first: Pose and steering angle to begin with; None: the pose of the settings.
        """
        self._limits = settings.limits
        self._built = settings.plant
        self._plant = settings.plant
        """As it is with the current fault."""
        self._is_ideal = _is_ideal(settings.plant)
        self._noise = _noise_source(settings.plant.noise)
        state = at_first or VehicleState(settings.pose, 0.0, 0.0)
        pose = replace(state.pose, yaw_rad=_wrapped(state.pose.yaw_rad))
        steering = _clipped(state.steering_angle_rad, settings.limits.max_steering_angle_rad)
        self._state = VehicleState(pose, 0.0, steering)
        self._command = DriveCommand(0.0, steering)
        self._expires_at: Instant | None = None
        self._coming: deque[tuple[Instant, DriveCommand]] = deque()
        self._start = start
        self._at = start
        """Time up to which the state is integrated."""
        self._reports: list[VehicleReport] = []
        self._reports_at = start
        self._next_report = start
        self._reporting = True
        self._fault: VehicleFault | None = None

    # --- what is done to it ----------------------------------------------------------------------

    def drive(self, command: DriveCommand, now: Instant) -> None:
        """Command the vehicle; values are clipped to its limits, and a non-finite one stops it."""
        self._catch_up(now)
        self._coming.append((now + self._plant.delay, command))
        self._catch_up(now)

    def set_reporting(self, reporting: bool, now: Instant) -> None:
        """Stop the reports of the vehicle, whatever its fault is, or resume them."""
        self._catch_up(now)
        self._reporting = reporting

    def set_fault(self, fault: VehicleFault | None, now: Instant) -> None:
        """Set the fault of the vehicle; None removes it."""
        self._catch_up(now)
        self._fault = fault
        self._plant = _with_weak_brakes(self._built) if fault is _WEAK_BRAKES else self._built
        self._is_ideal = _is_ideal(self._plant)
        # An ideal one does at once what it was told.
        self._follow(self._command)

    # --- what it does ----------------------------------------------------------------------------

    def advance(self, now: Instant) -> tuple[VehicleReport, ...]:
        """Return the reports due up to `now`."""
        self._catch_up(now)
        reports, self._reports = tuple(self._reports), []
        return reports

    def wake_at(self) -> Instant:
        """Return when the next report is due."""
        return self._reports_at if self._reports else self._next_report

    @property
    def state(self) -> VehicleState:
        """Return the actual state, without noise, at the last report or change of command."""
        return self._state

    @property
    def fault(self) -> VehicleFault | None:
        """Return its fault; None: it has none."""
        return self._fault

    @property
    def command(self) -> DriveCommand:
        """Return the command in effect."""
        return self._command

    # --- commands --------------------------------------------------------------------------------

    def _possible(self, command: DriveCommand) -> DriveCommand:
        """Return a command clipped to the limits; a non-finite one becomes a stop."""
        numbers = (command.speed_mps, command.steering_angle_rad)
        if not all(map(math.isfinite, numbers)):
            return replace(self._command, speed_mps=0.0)
        top, sharpest = self._limits.max_speed_mps, self._limits.max_steering_angle_rad
        return DriveCommand(
            _clipped(command.speed_mps, top), _clipped(command.steering_angle_rad, sharpest)
        )

    def _take_commands(self, now: Instant) -> None:
        while self._coming and self._coming[0][0] <= now:
            at, command = self._coming.popleft()
            self._follow(self._possible(command))
            self._expires_at = at + COMMAND_VALID_FOR
        if self._expires_at is not None and self._expires_at <= now:
            self._expires_at = None
            self._follow(replace(self._command, speed_mps=0.0))

    def _follow(self, command: DriveCommand) -> None:
        self._command = command
        if self._is_ideal:
            pose = self._state.pose
            self._state = VehicleState(pose, command.speed_mps, command.steering_angle_rad)

    # --- time ------------------------------------------------------------------------------------

    def _catch_up(self, now: Instant) -> None:
        """Process everything due up to `now`, each at its own time."""
        while (due := self._next_due()) <= now:
            self._integrate(due)
            self._take_commands(due)
            if due == self._next_report:
                self._next_report += REPORT_PERIOD
                if self._reporting and self._fault is not VehicleFault.SILENT:
                    self._reports.append(VehicleReport(self._measured()))
                    self._reports_at = due

    def _measured(self) -> VehicleState:
        """Return the state as the vehicle's sensors find it."""
        return self._state if self._noise is None else self._noise.added_to(self._state)

    def _next_due(self) -> Instant:
        due = self._next_report
        if self._coming:
            due = min(due, self._coming[0][0])
        return due if self._expires_at is None else min(due, self._expires_at)

    def _integrate(self, until: Instant) -> None:
        """Integrate up to `until`, in steps aligned to `start` that only events interrupt."""
        if self._rests:
            self._at = until
            return
        if self._is_ideal:
            state = self._state
            way = state.speed_mps * to_seconds(until - self._at)
            pose = self._moved(way, state.steering_angle_rad)
            self._state = VehicleState(pose, state.speed_mps, state.steering_angle_rad)
            self._at = until
            return
        while self._at < until:
            end = min(until, self._at + _STEP - (self._at - self._start) % _STEP)
            self._respond(to_seconds(end - self._at))
            self._at = end

    @property
    def _rests(self) -> bool:
        """Tell whether the vehicle is at rest and its command keeps it so."""
        state, command = self._state, self._command
        return (
            state.speed_mps == 0.0
            and command.speed_mps == 0.0
            and state.steering_angle_rad == command.steering_angle_rad
        )

    def _respond(self, dt_s: float) -> None:
        """Let speed and steering follow the command for `dt_s`, and move the vehicle."""
        plant, state, command = self._plant, self._state, self._command
        speed = state.speed_mps
        slower = abs(command.speed_mps) < abs(speed) or command.speed_mps * speed < 0.0
        limit = plant.braking_mps2 if slower else plant.acceleration_mps2
        new_speed = _approached(speed, command.speed_mps, plant.speed_lag_s, limit, dt_s)
        steering = _approached(
            state.steering_angle_rad,
            command.steering_angle_rad,
            plant.steering_lag_s,
            plant.steering_rate_radps,
            dt_s,
        )
        way = (speed + new_speed) / 2 * dt_s
        middle = (state.steering_angle_rad + steering) / 2
        self._state = VehicleState(self._moved(way, middle), new_speed, steering)

    def _moved(self, way_m: float, steering_angle_rad: float) -> Pose:
        """Return the pose at the end of an arc."""
        pose = self._state.pose
        half = way_m * math.tan(steering_angle_rad) / self._limits.wheelbase_m / 2
        # By the chord, which is exact also for arcs of almost no curvature.
        chord = way_m * math.sin(half) / half if half else way_m
        direction = pose.yaw_rad + half
        return Pose(
            pose.x_m + chord * math.cos(direction),
            pose.y_m + chord * math.sin(direction),
            _wrapped(direction + half),
        )


def _noise_source(noise: Noise) -> "_NoiseSource | None":
    """Return what adds the noise; None: there is none."""
    return _NoiseSource(noise) if noise.position_m or noise.yaw_rad or noise.speed_mps else None


class _NoiseSource:
    """Adds reproducible noise. The first one makes numpy load its random numbers, with 2 MB."""

    def __init__(self, noise: Noise) -> None:
        self._noise = noise
        self._random = np.random.Generator(np.random.PCG64(noise.seed))

    def added_to(self, state: VehicleState) -> VehicleState:
        noise = self._noise
        x, y, yaw, speed = self._random.standard_normal(4).tolist()
        pose = Pose(
            state.pose.x_m + noise.position_m * x,
            state.pose.y_m + noise.position_m * y,
            _wrapped(state.pose.yaw_rad + noise.yaw_rad * yaw),
        )
        return replace(state, pose=pose, speed_mps=state.speed_mps + noise.speed_mps * speed)


def _with_weak_brakes(plant: Plant) -> Plant:
    braking = plant.braking_mps2
    weak = WEAK_BRAKING_MPS2 if braking is None else min(braking, WEAK_BRAKING_MPS2)
    return replace(plant, braking_mps2=weak)


def _is_ideal(plant: Plant) -> bool:
    """Tell whether speed and steering follow instantly, so that the vehicle drives exact arcs."""
    limits = (plant.acceleration_mps2, plant.braking_mps2, plant.steering_rate_radps)
    return limits == (None, None, None) and plant.speed_lag_s == plant.steering_lag_s == 0.0


def _approached(
    value: float, target: float, lag_s: float, rate: float | None, dt_s: float
) -> float:
    """Return the value of a first-order lag with a limited rate after `dt_s`.

    Args:
        value: Current value.
        target: Commanded value.
        lag_s: Time constant, s; 0: none.
        rate: Largest rate of change, per second; None: unlimited.
        dt_s: Time step, s.
    """
    wanted = target - value
    if lag_s > 0:
        wanted *= 1 - math.exp(-dt_s / lag_s)
    if rate is not None:
        wanted = _clipped(wanted, rate * dt_s)
    there = abs(target - value - wanted) < _AS_GOOD_AS_THERE
    return target if there else value + wanted


def _clipped(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)


def _wrapped(angle: float) -> float:
    """Return an angle wrapped to [-pi, pi], rad."""
    return math.remainder(angle, math.tau)
