"""Limits of approaches as a robot has them of which nothing is said."""

from domain.paths.approach import ApproachLimits, near_path_m
from domain.paths.speed_profile import SpeedLimits
from domain.vehicle import VehicleLimits

USUAL = VehicleLimits()


def approach_limits(
    vehicle: VehicleLimits = USUAL, speed: SpeedLimits | None = None, from_m: float = 5.0
) -> ApproachLimits:
    """Return the limits of a vehicle, which begins at most `from_m` from its path."""
    return ApproachLimits(vehicle, speed or SpeedLimits(), near_path_m(vehicle), from_m)
