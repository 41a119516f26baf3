"""What can be set about the vehicle: its limits, and how a simulated one begins and responds."""

from typing import Annotated, TypeAlias

from pydantic import Field

from domain.vehicle import VehicleLimits
from service.files.robot_settings import Number, SettingsBlock

Coordinate: TypeAlias = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]
Rate: TypeAlias = Annotated[float, Field(gt=0, le=1_000, allow_inf_nan=False)]
Lag: TypeAlias = Annotated[float, Field(ge=0, le=60, allow_inf_nan=False)]
Deviation: TypeAlias = Annotated[float, Field(ge=0, le=100, allow_inf_nan=False)]


class PoseBlock(SettingsBlock):
    """Where the simulated vehicle begins; middle of the rear axle."""

    x_m: Coordinate = 0.0
    """In m."""
    y_m: Coordinate = 0.0
    """In m."""
    yaw_rad: Number = 0.0
    """Counter-clockwise from the x axis, in rad."""


class NoiseBlock(SettingsBlock):
    """What the simulated sensors add to each report, as standard deviations."""

    position_m: Deviation = 0.0
    """To x and to y, in m."""
    yaw_rad: Deviation = 0.0
    """To the heading, in rad."""
    speed_mps: Deviation = 0.0
    """To the speed, in m/s."""
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] = 0
    """The same seed adds the same noise."""


class PlantBlock(SettingsBlock):
    """How the simulated vehicle follows its commands. What is left out: at once."""

    acceleration_mps2: Rate | None = None
    """Greatest acceleration, in m/s2."""
    braking_mps2: Rate | None = None
    """Greatest deceleration, in m/s2."""
    steering_rate_radps: Rate | None = None
    """Greatest rate of the front wheels' angle, in rad/s."""
    steering_lag_s: Lag = 0.0
    """Time constant of the steering, in s."""
    speed_lag_s: Lag = 0.0
    """Time constant of the speed, in s."""
    delay_s: Lag = 0.0
    """From a command to when it takes effect, in s."""
    noise: NoiseBlock = NoiseBlock()
    """What the sensors add."""


class VehicleBlock(SettingsBlock):
    """The vehicle. What is left out is that of the Polaris GEM e2."""

    wheelbase_m: Annotated[float, Field(ge=0.1, le=20, allow_inf_nan=False)] = 1.75
    """Between the axles, in m."""
    max_steering_angle_rad: Annotated[float, Field(ge=0.01, le=1.5, allow_inf_nan=False)] = 0.61
    """Of the front wheels, to either side, in rad."""
    max_speed_mps: Annotated[float, Field(gt=0, le=100, allow_inf_nan=False)] = 11.2
    """In m/s; a task may ask for no more."""
    pose: PoseBlock = PoseBlock()
    """Where the simulated vehicle begins."""
    plant: PlantBlock = PlantBlock()
    """How the simulated vehicle responds. Left out: ideally."""

    def to_limits(self) -> VehicleLimits:
        """Return what the vehicle can do, real or simulated."""
        return VehicleLimits(self.wheelbase_m, self.max_steering_angle_rad, self.max_speed_mps)
