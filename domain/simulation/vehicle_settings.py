"""Settings of a simulated vehicle: initial pose, dynamics and sensor noise."""

from dataclasses import dataclass, field
from enum import StrEnum

from domain.timebase import Duration
from domain.vehicle import Pose, VehicleLimits

ORIGIN = Pose(0.0, 0.0, 0.0)


class VehicleFault(StrEnum):
    """A fault of the vehicle; it lasts until it is replaced or removed."""

    SILENT = "silent"
    """It reports no pose, like a lost localization."""
    WEAK_BRAKES = "weak_brakes"
    """It brakes with `WEAK_BRAKING_MPS2` at most."""


WEAK_BRAKING_MPS2 = 0.3


@dataclass(frozen=True, slots=True)
class Noise:
    """Standard deviations of the noise of each report; 0: none."""

    position_m: float = 0.0
    yaw_rad: float = 0.0
    speed_mps: float = 0.0
    seed: int = 0
    """Two vehicles with the same seed report the same noise."""


@dataclass(frozen=True, slots=True)
class Plant:
    """Dynamics of a vehicle; limits that are None do not apply."""

    acceleration_mps2: float | None = None
    braking_mps2: float | None = None
    steering_rate_radps: float | None = None
    steering_lag_s: float = 0.0
    """Time constant of the steering, s; 0: none."""
    speed_lag_s: float = 0.0
    """Time constant of the speed, s; 0: none."""
    delay: Duration = 0
    """Delay until a command takes effect."""
    noise: Noise = field(default_factory=Noise)


@dataclass(frozen=True, slots=True)
class VehicleSettings:
    """A simulated vehicle; the default is ideal, at standstill at the origin."""

    pose: Pose = ORIGIN
    plant: Plant = field(default_factory=Plant)
    limits: VehicleLimits = field(default_factory=VehicleLimits)
