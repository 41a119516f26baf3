"""Whatever path is driven from wherever, by whatever vehicle: it ends, and it ends as it is told.

The whole of it runs as it does live: supervision, navigation, and the simulated vehicle. What was
driven is judged by where the vehicle really was. `make soak` drives 10,000 times, `make test` 500.
"""

import os
from dataclasses import dataclass, replace
from math import cos, isfinite, pi, radians, sin

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import event, given, settings
from numpy.typing import NDArray

from domain.commands import Drive
from domain.parts.system_model import SmhModel
from domain.paths.path import Path
from domain.simulation.vehicle_settings import Noise, Plant, VehicleSettings
from domain.snapshot import TaskPhase
from domain.supervision import SupervisionSettings
from domain.timebase import seconds, to_seconds
from domain.tracking.trackers import TRACKERS
from domain.vehicle import Pose, VehicleLimits
from service.files.robot_settings import SignalsBlock
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.random_paths import Walk, evenly, passed_share, walks
from tests.support.track_study import PLANTS

SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
EXAMPLES = 10_000 if SOAK else 100

LIMITS = VehicleLimits()
MOST_M = 60.0
MOST_S = 8.0
"""At the speed asked for; a slow vehicle gets a shorter path, or a run would take minutes."""
NEAR_M = 3.0
"""So near is passed; navigation lets a vehicle no further off its path for long."""
COVERED = 0.95
_PLACES = 401
_SIGMAS = 5.0
"""What navigation is told is off by no more of its noise than this, in all that is driven here."""
_PERIOD_S = 0.05
_LOOK_M = 0.02
"""So much nearer a vehicle of 11 m/s may come between two looks at it: hypot(3, 0.28) - 3."""
_ENDS = frozenset({TaskPhase.SUCCEEDED, TaskPhase.ABORTED})
_NEVER_STALE = SupervisionSettings(SignalsBlock(stale_after_s=0.0).to_domain())


@dataclass(frozen=True, slots=True)
class Errand:
    """One drive before it is driven."""

    walk: Walk
    controller: str
    speed_mps: float
    plant: Plant
    beside_m: float
    """How far from the first waypoint the vehicle stands."""
    bearing_rad: float
    """In which direction from there."""
    yaw_rad: float
    held_s: tuple[float, float]
    """After how many seconds somebody holds it, and for how many; 0: nobody does."""

    @property
    def waypoints(self) -> NDArray[np.float64]:
        """Return its path as waypoints, shape (n, 3)."""
        return self.walk.waypoints(min(MOST_M, MOST_S * self.speed_mps))

    @property
    def start(self) -> Pose:
        """Return where the vehicle stands; the path begins at the origin."""
        x_m, y_m = self.beside_m * cos(self.bearing_rad), self.beside_m * sin(self.bearing_rad)
        return Pose(x_m, y_m, self.yaw_rad)


def plants() -> st.SearchStrategy[Plant]:
    """Generate vehicles that are late, and whose sensors are noisy."""
    noises = st.one_of(
        st.just(Noise()),
        st.builds(
            Noise,
            position_m=st.sampled_from([0.02, 0.1]),
            yaw_rad=st.sampled_from([radians(0.5), radians(2)]),
            speed_mps=st.sampled_from([0.0, 0.1]),
            seed=st.integers(0, 9),
        ),
    )
    delays = st.sampled_from([0.0, 0.013, 0.05, 0.1, 0.2]).map(seconds)
    kinds = st.sampled_from(list(PLANTS.values()))
    return st.builds(lambda k, d, n: replace(k, delay=d, noise=n), kinds, delays, noises)


ANGLES = st.one_of(st.just(0.0), st.floats(-0.5, 0.5), st.floats(-pi, pi))
ERRANDS = st.builds(
    Errand,
    walk=walks(),
    controller=st.sampled_from(sorted(TRACKERS)),
    speed_mps=st.one_of(st.just(2.8), st.floats(1.0, 11.0)),
    plant=plants(),
    beside_m=st.one_of(st.just(0.0), st.floats(0.0, 3.0)),
    bearing_rad=ANGLES,
    yaw_rad=ANGLES,
    held_s=st.one_of(
        st.just((0.0, 0.0)),
        st.just((0.0, 0.0)),
        st.tuples(st.floats(0.0, 8.0), st.floats(0.05, 3.0)),
    ),
)


class Outing:
    """A drive up to its end, and where the vehicle really was meanwhile."""

    def __init__(self, errand: Errand) -> None:
        self.errand = errand
        self.path = Path(errand.waypoints)
        vehicle = VehicleSettings(errand.start, errand.plant, LIMITS)
        self.robot = CoreRobot(SmhModel({}, {}), _NEVER_STALE, vehicle=vehicle)
        self.robot.read(**GOOD)
        self.robot.submit_task(self.path, controller=errand.controller, speed_mps=errand.speed_mps)
        self.places: list[tuple[float, float]] = []
        self._look()
        for _ in range(round(self.longest_s / _PERIOD_S)):
            if self.robot.task.status in _ENDS:
                break
            self._hold_or_release()
            self.robot.advance(_PERIOD_S)
            self._look()

    @property
    def longest_s(self) -> float:
        """Return within how many seconds it has to end.

        A vehicle that goes nowhere is given up after 20 s. One that goes on is as fast as its task,
        its bends of 2 m/s at least, and its acceleration allow; that it loses its path and turns
        back to it makes it several times as long. What holds it adds its time.
        """
        driving_s = 4 * self.path.length_m / min(self.errand.speed_mps, 2.0)
        return 60.0 + driving_s + self.errand.held_s[1]

    def passed_share(self) -> float:
        """Return how much of the path the vehicle really passed, in its order, 0 to 1."""
        within_m = NEAR_M + _SIGMAS * self.errand.plant.noise.position_m + _LOOK_M
        places = evenly(self.errand.waypoints, _PLACES)
        return passed_share(places, np.array(self.places), within_m)

    def drives(self) -> list[Drive]:
        """Return what the vehicle was told so far."""
        return [command for command in self.robot.commands if isinstance(command, Drive)]

    def rest(self) -> float:
        """Let the vehicle brake, and a second pass; return how fast it then is, m/s."""
        vehicle = self.robot.robot.vehicle
        braking = self.errand.plant.braking_mps2
        braking_s = 0.0 if braking is None else abs(vehicle.state.speed_mps) / braking
        self.robot.advance(1.0 + braking_s)
        return vehicle.state.speed_mps

    def _hold_or_release(self) -> None:
        after_s, for_s = self.errand.held_s
        since_s = to_seconds(self.robot.now) - after_s
        held = bool(self.robot.core.driving.holds)
        if 0 <= since_s < for_s and not held:
            self.robot.hold()
        elif since_s >= for_s and held:
            self.robot.release()

    def _look(self) -> None:
        pose = self.robot.robot.vehicle.state.pose
        self.places.append((pose.x_m, pose.y_m))


@settings(max_examples=EXAMPLES)
@pytest.mark.timeout(0 if SOAK else 60)
@given(ERRANDS)
def test_every_drive_ends_and_ends_as_it_is_told(errand: Errand) -> None:
    outing = Outing(errand)
    task = outing.robot.task
    event(str(task.status))
    assert task.status in _ENDS, f"still {task.status} after {outing.longest_s:.0f} s"
    until_end = len(outing.drives())
    if task.status is TaskPhase.ABORTED:
        assert task.reason
    else:
        assert outing.passed_share() >= COVERED
    assert outing.rest() == 0.0
    for drive in outing.drives():
        speed, steering = drive.command.speed_mps, drive.command.steering_angle_rad
        assert isfinite(speed)
        assert isfinite(steering)
        assert 0.0 <= speed <= min(errand.speed_mps, LIMITS.max_speed_mps)
        assert abs(steering) <= LIMITS.max_steering_angle_rad
    # Nothing is commanded once it has ended, and last that it stands.
    assert len(outing.drives()) == until_end
    assert outing.drives()[-1].command.speed_mps == 0.0
