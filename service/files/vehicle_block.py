"""Settings of the vehicle: its limits, and initial pose and dynamics of a simulated one."""

from typing import Annotated, TypeAlias

from pydantic import Field

from domain.vehicle import DEFAULT_FRAME, VehicleLimits
from service.files.settings_block import Number, SettingsBlock

Coordinate: TypeAlias = Annotated[float, Field(ge=-1e7, le=1e7, allow_inf_nan=False)]
Rate: TypeAlias = Annotated[float, Field(gt=0, le=1_000, allow_inf_nan=False)]
Lag: TypeAlias = Annotated[float, Field(ge=0, le=60, allow_inf_nan=False)]
FrameId: TypeAlias = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_/]{0,99}$")]
Deviation: TypeAlias = Annotated[float, Field(ge=0, le=100, allow_inf_nan=False)]


class PoseBlock(SettingsBlock):
    """Initial pose of the simulated vehicle, at the centre of the rear axle."""

    x_m: Coordinate = 0.0
    """Position x, in m."""
    y_m: Coordinate = 0.0
    """Position y, in m."""
    yaw_rad: Number = 0.0
    """Heading, counter-clockwise from the x axis, in rad."""


class NoiseBlock(SettingsBlock):
    """Standard deviations of the noise of the simulated sensors."""

    position_m: Deviation = 0.0
    """Noise of x and y, in m."""
    yaw_rad: Deviation = 0.0
    """Noise of the heading, in rad."""
    speed_mps: Deviation = 0.0
    """Noise of the speed, in m/s."""
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] = 0
    """Seed of the noise; the same seed gives the same noise."""


class PlantBlock(SettingsBlock):
    """Dynamics of the vehicle; limits that are not set do not apply.

    A simulated vehicle responds so. The speed of tasks takes braking and steering of any vehicle
    into account.
    """

    acceleration_mps2: Rate | None = None
    """Largest acceleration, in m/s2."""
    braking_mps2: Rate | None = None
    """Largest deceleration, in m/s2."""
    steering_rate_radps: Rate | None = None
    """Largest rate of the front wheel angle, in rad/s."""
    steering_lag_s: Lag = 0.0
    """Time constant of the steering, in s."""
    speed_lag_s: Lag = 0.0
    """Time constant of the speed, in s."""
    delay_s: Lag = 0.0
    """Delay until a command takes effect, in s."""
    noise: NoiseBlock = NoiseBlock()
    """Noise of the sensors."""


class VehicleBlock(SettingsBlock):
    """The vehicle. The defaults are those of the Polaris GEM e2."""

    wheelbase_m: Annotated[float, Field(ge=0.1, le=20, allow_inf_nan=False)] = 1.75
    """Distance between the axles, in m."""
    max_steering_angle_rad: Annotated[float, Field(ge=0.01, le=1.5, allow_inf_nan=False)] = 0.61
    """Largest front wheel angle to either side, in rad."""
    max_speed_mps: Annotated[float, Field(gt=0, le=100, allow_inf_nan=False)] = 11.2
    """Top speed, in m/s; upper limit of the cruise speed of a task."""
    pose: PoseBlock = PoseBlock()
    """Initial pose of the simulated vehicle."""
    plant: PlantBlock = PlantBlock()
    """Dynamics of the vehicle. Default: ideal."""
    frame_id: FrameId = DEFAULT_FRAME
    """Coordinate frame of waypoints and poses, as ROS names it: for what is drawn in RViz."""

    def to_limits(self) -> VehicleLimits:
        """Return the limits of the vehicle, real or simulated."""
        plant = self.plant
        return VehicleLimits(
            self.wheelbase_m,
            self.max_steering_angle_rad,
            self.max_speed_mps,
            plant.braking_mps2,
            plant.steering_rate_radps,
            plant.steering_lag_s + plant.delay_s,
        )
