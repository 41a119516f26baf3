"""What can be set about tasks and how they are driven, and the task to begin with."""

from typing import Annotated, TypeAlias

from pydantic import AfterValidator, Field

from domain.navigation import NavigationSettings
from domain.paths.speed_profile import SpeedLimits
from domain.tasks.settings import TaskSettings
from domain.timebase import seconds
from domain.tracking.trackers import TRACKERS
from service.files.robot_settings import Seconds, SettingsBlock

Positive: TypeAlias = Annotated[float, Field(gt=0, le=1_000, allow_inf_nan=False)]
SomeSeconds: TypeAlias = Annotated[float, Field(gt=0, le=86_400, allow_inf_nan=False)]


class DrivingBlock(SettingsBlock):
    """When a task may begin, how fast it is driven, and when it is given up."""

    max_start_distance_m: Positive = 5.0
    """A path that begins further from the vehicle is refused."""
    pose_stale_after_s: SomeSeconds = 0.3
    """A pose that is older holds the task."""
    max_cross_track_m: Positive = 3.0
    """Further beside the path, for `max_cross_track_for_s`, the task is given up."""
    max_cross_track_for_s: Seconds = 1.0
    """For how many seconds."""
    no_progress_for_s: SomeSeconds = 20.0
    """A task that comes no further for so many seconds is given up."""
    lateral_acceleration_mps2: Positive = 2.0
    """Curves are driven so that no more than this is felt, in m/s2."""
    acceleration_mps2: Positive = 1.0
    """How quickly the commanded speed rises, in m/s2."""
    braking_mps2: Positive = 1.0
    """How quickly the commanded speed falls before curves and the end, in m/s2."""

    def to_task_settings(self) -> TaskSettings:
        """Return what the supervision wants to know."""
        return TaskSettings(
            max_start_distance_m=self.max_start_distance_m,
            pose_stale_after=seconds(self.pose_stale_after_s),
        )

    def to_navigation_settings(self) -> NavigationSettings:
        """Return what the navigation wants to know."""
        return NavigationSettings(
            max_cross_track_m=self.max_cross_track_m,
            max_cross_track_for=seconds(self.max_cross_track_for_s),
            no_progress_for=seconds(self.no_progress_for_s),
            speed=SpeedLimits(
                lateral_acceleration_mps2=self.lateral_acceleration_mps2,
                acceleration_mps2=self.acceleration_mps2,
                braking_mps2=self.braking_mps2,
            ),
        )


def _known_controller(name: str) -> str:
    if name not in TRACKERS:
        raise ValueError(f"there is no path tracker {name!r}; there are {', '.join(TRACKERS)}")
    return name


Controller: TypeAlias = Annotated[
    str, AfterValidator(_known_controller), Field(json_schema_extra={"enum": [*TRACKERS]})
]


class StartTaskBlock(SettingsBlock):
    """A task that is submitted when the service starts; it waits until nothing holds it."""

    file: str = Field(min_length=1, max_length=1_000)
    """CSV with `x,y,yaw` in m, m and rad; a relative path counts from the robot file."""
    controller: Controller = "pure_pursuit"
    """What follows the path."""
    speed_mps: Positive = 2.8
    """Cruise speed, in m/s."""
