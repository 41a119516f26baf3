"""Settings of tasks and navigation, and the start task."""

from typing import Annotated, Literal, TypeAlias

from pydantic import AfterValidator, Field

from domain.errors import InvalidValueError
from domain.navigation import NavigationSettings
from domain.paths.speed_profile import SpeedLimits
from domain.tasks.settings import TaskSettings
from domain.timebase import seconds
from domain.tracking.trackers import TRACKERS
from service.files.csv_columns import column_names
from service.files.settings_block import Seconds, SettingsBlock

DEFAULT_CONTROLLER = "pure_pursuit"
DEFAULT_SPEED_MPS = 2.8
"""Of a task of which nothing else is said."""

Positive: TypeAlias = Annotated[float, Field(gt=0, le=1_000, allow_inf_nan=False)]
SomeSeconds: TypeAlias = Annotated[float, Field(gt=0, le=86_400, allow_inf_nan=False)]


class DrivingBlock(SettingsBlock):
    """When a task may begin, how fast it is driven, and when it is aborted."""

    max_start_distance_m: Positive = 5.0
    """Largest distance from the vehicle to the start of a path, in m; others are rejected."""
    pose_stale_after_s: SomeSeconds = 0.3
    """A pose older than this, in seconds, holds the task."""
    max_cross_track_m: Positive | None = None
    """A larger cross-track error, in m, for `max_cross_track_for_s` aborts the task. Default: 3 m,
    and less for a wheelbase below 1.75 m, in proportion."""
    max_cross_track_for_s: Seconds = 1.0
    """Time with a larger cross-track error after which the task is aborted, in seconds."""
    no_progress_for_s: SomeSeconds = 20.0
    """Time without progress after which the task is aborted, in seconds."""
    lateral_acceleration_mps2: Positive = 2.0
    """Largest lateral acceleration in bends, in m/s2; it limits the speed there."""
    acceleration_mps2: Positive = 1.0
    """Rate at which the commanded speed rises, in m/s2."""
    braking_mps2: Positive = 1.0
    """Rate at which the commanded speed falls before bends and the end, in m/s2. A vehicle that
    needs 1 s more than 1.25 times the time to stop at this rate counts as still moving."""

    def to_task_settings(self) -> TaskSettings:
        """Return the settings for the supervision."""
        return TaskSettings(
            max_start_distance_m=self.max_start_distance_m,
            pose_stale_after=seconds(self.pose_stale_after_s),
            braking_mps2=self.braking_mps2,
        )

    def to_navigation_settings(self) -> NavigationSettings:
        """Return the settings for the navigation."""
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
        raise ValueError(f"unknown path tracker {name!r}; known: {', '.join(TRACKERS)}")
    return name


Controller: TypeAlias = Annotated[
    str, AfterValidator(_known_controller), Field(json_schema_extra={"enum": [*TRACKERS]})
]


def _known_columns(text: str) -> str:
    try:
        column_names(text)
    except InvalidValueError as error:
        raise ValueError(error.message) from error
    return text


class StartTaskBlock(SettingsBlock):
    """A task that is submitted when the service starts; it waits until there are no holds."""

    file: str = Field(min_length=1, max_length=1_000)
    """CSV file of waypoints; a relative path is relative to the robot file."""
    heading: Literal["rad", "deg", "compass", "rad_north", "rad_compass"] | None = None
    """Unit of the headings. Default: the one that is named in the file, or fits the path."""
    columns: Annotated[str, AfterValidator(_known_columns)] | None = None
    """Names of the columns, such as `s,x,y,yaw`. Default: those in the file, or `x,y,yaw`."""
    controller: Controller = DEFAULT_CONTROLLER
    """Path tracker."""
    speed_mps: Positive = DEFAULT_SPEED_MPS
    """Cruise speed, in m/s."""


class TasksBlock(SettingsBlock):
    """Tasks that clients begin by the name of a waypoint file."""

    folder: str = Field(min_length=1, max_length=1_000)
    """Folder of waypoint files; a relative path is relative to the robot file. The ROS service
    `/serve_waypoints` drives a file in it by its name, and no other file."""
