"""Drives in virtual time, with a look at all that is commanded."""

from dataclasses import dataclass, field
from math import tan

import numpy as np
from numpy.typing import NDArray

from domain.parts.system_model import SmhModel
from domain.paths.path import Path
from domain.simulation.vehicle_settings import Plant, VehicleSettings
from domain.snapshot import TaskPhase
from domain.supervision import SupervisionSettings
from domain.timebase import seconds, to_seconds
from domain.vehicle import Pose, VehicleLimits
from service.files.robot_settings import SignalsBlock
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.track_study import limits_of

PERIOD_S = 0.05
ENDS = frozenset({TaskPhase.SUCCEEDED, TaskPhase.ABORTED})
LIMITS = VehicleLimits()


def through(*places: tuple[float, float]) -> Path:
    """Return the path through places, x and y in m."""
    return Path(np.array([(x, y, 0.0) for x, y in places]))


@dataclass(slots=True)
class Look:
    """What was commanded, and where the vehicle was, in one control period."""

    speed_mps: float
    commanded_rad: float
    steering_rad: float
    error_m: float
    place: tuple[float, float]


@dataclass(slots=True)
class Trip:
    """One task from its submission to its end."""

    path: Path
    controller: str = "stanley"
    speed_mps: float = 2.8
    plant: Plant = field(default_factory=Plant)
    start: Pose = field(default_factory=lambda: Pose(0.0, 0.0, 0.0))
    limits: VehicleLimits = LIMITS
    looks: list[Look] = field(default_factory=list)
    robot: CoreRobot = field(init=False)

    def __post_init__(self) -> None:
        known = limits_of(self.plant, self.limits)
        never_stale = SignalsBlock(stale_after_s=0.0).to_domain()
        settings = SupervisionSettings(never_stale, vehicle=known)
        vehicle = VehicleSettings(self.start, self.plant, self.limits)
        self.robot = CoreRobot(SmhModel({}, {}), settings, vehicle=vehicle)
        self.robot.read(**GOOD)
        self.robot.submit_task(self.path, controller=self.controller, speed_mps=self.speed_mps)

    @property
    def ended(self) -> bool:
        """Tell whether the task ended."""
        return self.robot.task.status in ENDS

    def drive(self, duration_s: float = 600.0) -> None:
        """Let time pass until the task ends."""
        end = self.robot.now + seconds(duration_s)
        while not self.ended and self.robot.now < end:
            self.robot.advance(PERIOD_S)
            self._look()

    def hold(self, for_s: float = 600.0) -> None:
        """Hold the task until the vehicle stands, or for a time, and release it."""
        if self.ended:
            return
        self.robot.hold()
        end = self.robot.now + seconds(for_s)
        while self.robot.task.status is TaskPhase.PAUSING and self.robot.now < end:
            self.robot.advance(PERIOD_S)
            self._look()
        self.robot.release()

    @property
    def time_s(self) -> float:
        """Return how long it took so far, s."""
        return to_seconds(self.robot.now)

    @property
    def places(self) -> NDArray[np.float64]:
        """Return where the vehicle was, shape (n, 2), m."""
        return np.array([look.place for look in self.looks])

    def lateral_mps2(self) -> float:
        """Return the largest lateral acceleration of what was commanded, m/s2.

        With the steering angle that was commanded, and with the one that was there.
        """
        return max(
            look.speed_mps**2 * abs(tan(angle)) / self.limits.wheelbase_m
            for look in self.looks
            for angle in (look.commanded_rad, look.steering_rad)
        )

    def largest_error_m(self, after: int = 0) -> float:
        """Return the largest cross-track error from a look on, m."""
        return max(abs(look.error_m) for look in self.looks[after:])

    def _look(self) -> None:
        view, task = self.robot.core.driving.vehicle, self.robot.task
        state = view.state
        if state is None or task.cross_track_error_m is None or task.status in ENDS:
            return
        command = view.command
        self.looks.append(
            Look(
                command.speed_mps,
                command.steering_angle_rad,
                state.steering_angle_rad,
                task.cross_track_error_m,
                (state.pose.x_m, state.pose.y_m),
            )
        )
