"""Tasks, holds and the vehicle as clients see them."""

from typing import Annotated

from pydantic import Field

from api.http.schemas.base import BlockerJson, Body, Json, Timestamp, timestamp, timestamp_or_none
from api.http.schemas.problem import WithIgnored
from domain.snapshot import HoldView, TaskPhase, TaskView, VehicleView
from domain.tracking.trackers import TRACKERS
from domain.vehicle import DriveCommand, Point, Pose, VehicleLimits
from service.clock import Clock
from service.files.driving_block import DEFAULT_CONTROLLER, DEFAULT_SPEED_MPS

MAX_HOLD_REASON = 500

DIGITS = 6
"""Decimals of m, rad and m/s in JSON: micrometres, without the noise of the last bits."""

Controller = Annotated[
    str, Field(max_length=64, description=f"A path tracker: {', '.join(TRACKERS)}")
]
Number = Annotated[float, Field(allow_inf_nan=False)]


class WaypointBody(Body):
    """One waypoint for the centre of the rear axle."""

    x_m: float
    y_m: float
    yaw_rad: float = Field(description="Heading, counter-clockwise from the x axis")


class TaskBody(Body):
    """A path to follow."""

    waypoints: list[WaypointBody]
    start_index: int = Field(default=0, ge=0, description="Index of the first waypoint to drive to")
    controller: Controller = DEFAULT_CONTROLLER
    speed_mps: Number = Field(
        default=DEFAULT_SPEED_MPS,
        description="Cruise speed; lower in bends and towards the end",
    )


class TaskJson(Json):
    """A task: its path, its progress, and why it is held or how it ended."""

    id: str
    status: TaskPhase
    controller: str
    speed_mps: float
    waypoint_count: int
    length_m: float = Field(description="Length of the path from `start_index` to its end")
    start_index: int
    target_index: int = Field(description="First waypoint that is not yet passed")
    progress: float = Field(description="Covered share of `length_m`, 0 to 1")
    distance_m: float = Field(description="Distance covered along the path, from `start_index`")
    cross_track_error_m: float | None = Field(
        description="Positive: left of the path; null: the task never ran"
    )
    reason: str | None = Field(description="Why it is held, or how it ended")
    created_at: Timestamp
    ended_at: Timestamp | None

    @classmethod
    def of(cls, view: TaskView, clock: Clock) -> "TaskJson":
        """Show `view`."""
        return cls(
            id=view.id,
            status=view.status,
            controller=view.controller,
            speed_mps=view.speed_mps,
            waypoint_count=view.waypoint_count,
            length_m=round(view.length_m, DIGITS),
            start_index=view.start_index,
            target_index=view.target_index,
            progress=round(view.progress, DIGITS),
            distance_m=round(view.distance_m, DIGITS),
            cross_track_error_m=_rounded(view.cross_track_error_m),
            reason=view.reason,
            created_at=timestamp(clock, view.created_at),
            ended_at=timestamp_or_none(clock, view.ended_at),
        )


class TasksJson(Json):
    """Tasks, the newest first."""

    items: list[TaskJson]
    controllers: list[str] = Field(description="Available path trackers")


class WaypointJson(Json):
    """One waypoint."""

    x_m: float
    y_m: float
    yaw_rad: float


class WaypointsJson(Json):
    """Waypoints of a task."""

    waypoint_count: int = Field(description="Number of waypoints of the task")
    indices: list[int] = Field(description="Indices of `items` in the task")
    items: list[WaypointJson]


class PoseJson(Json):
    """Position and heading of the centre of the rear axle."""

    x_m: float
    y_m: float
    yaw_rad: float

    @classmethod
    def of(cls, pose: Pose) -> "PoseJson":
        """Show `pose`."""
        return cls(
            x_m=round(pose.x_m, DIGITS),
            y_m=round(pose.y_m, DIGITS),
            yaw_rad=round(pose.yaw_rad, DIGITS),
        )


class PointJson(Json):
    """A position on the ground."""

    x_m: float
    y_m: float

    @classmethod
    def of(cls, point: Point) -> "PointJson":
        """Show `point`."""
        return cls(x_m=round(point.x_m, DIGITS), y_m=round(point.y_m, DIGITS))


class DriveCommandJson(Json):
    """The last command to the vehicle."""

    speed_mps: float
    steering_angle_rad: float

    @classmethod
    def of(cls, command: DriveCommand) -> "DriveCommandJson":
        """Show `command`."""
        return cls(
            speed_mps=round(command.speed_mps, DIGITS),
            steering_angle_rad=round(command.steering_angle_rad, DIGITS),
        )


class VehicleLimitsJson(Json):
    """Limits of the vehicle."""

    wheelbase_m: float
    max_steering_angle_rad: float
    max_speed_mps: float

    @classmethod
    def of(cls, limits: VehicleLimits) -> "VehicleLimitsJson":
        """Show `limits`."""
        return cls(
            wheelbase_m=limits.wheelbase_m,
            max_steering_angle_rad=limits.max_steering_angle_rad,
            max_speed_mps=limits.max_speed_mps,
        )


class VehicleJson(Json):
    """Pose and motion of the vehicle, and its command."""

    pose: PoseJson | None = Field(description="null: never reported")
    speed_mps: float | None
    steering_angle_rad: float | None = Field(description="Front wheel angle, left positive")
    command: DriveCommandJson
    lookahead: PointJson | None = Field(
        description="Point that the tracker steers to; null: no task is driving"
    )
    at: Timestamp | None = Field(description="When the pose was reported")
    still_moving: BlockerJson | None = Field(
        description="The vehicle should stand, and does not or is not known to"
    )
    limits: VehicleLimitsJson

    @classmethod
    def of(cls, view: VehicleView, limits: VehicleLimits, clock: Clock) -> "VehicleJson":
        """Show `view`."""
        state, moving = view.state, view.still_moving
        return cls(
            pose=None if state is None else PoseJson.of(state.pose),
            speed_mps=None if state is None else round(state.speed_mps, DIGITS),
            steering_angle_rad=(None if state is None else round(state.steering_angle_rad, DIGITS)),
            command=DriveCommandJson.of(view.command),
            lookahead=None if view.lookahead is None else PointJson.of(view.lookahead),
            at=timestamp_or_none(clock, view.at),
            still_moving=None if moving is None else BlockerJson.of(moving, clock),
            limits=VehicleLimitsJson.of(limits),
        )


class HoldBody(Body):
    """Why a hold is set."""

    reason: str = Field(default="", max_length=MAX_HOLD_REASON)


class HoldJson(Json):
    """One hold: while it is set, no task runs."""

    owner: str
    reason: str
    by: str = Field(description="Who set it; empty: Pilothouse itself")
    since_at: Timestamp

    @classmethod
    def of(cls, view: HoldView, clock: Clock) -> "HoldJson":
        """Show `view`."""
        return cls(
            owner=view.owner,
            reason=view.reason,
            by=view.by,
            since_at=timestamp(clock, view.since),
        )


class HoldAnswerJson(HoldJson, WithIgnored):
    """A hold after it was set."""


class HoldsJson(Json):
    """All holds, the oldest first; a task runs only while there are none."""

    items: list[HoldJson]


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, DIGITS)
