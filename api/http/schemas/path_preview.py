"""The preview of a path as clients see it."""

from pydantic import Field

from api.http.schemas.base import Json
from api.http.schemas.tasks import PointJson
from domain.paths.preview import PathPreview

MAX_DRAWN = 2_000


class SpacingJson(Json):
    """Distances between waypoints."""

    min_m: float
    median_m: float
    max_m: float


class StartJson(Json):
    """Distance and heading error of the vehicle at the start of the path."""

    distance_m: float
    heading_error_rad: float = Field(description="Heading of the vehicle minus heading of the path")


class ApproachJson(Json):
    """How the vehicle gets onto the path: slowly, forward, and in loops where it must turn."""

    distance_m: float = Field(description="Distance of the vehicle from the path")
    turn_rad: float = Field(description="How far it has to turn, left positive")
    speed_mps: float = Field(description="Speed until it is on the path")
    length_m: float = Field(description="Distance that it drives until it is on the path")


class PathWarningJson(Json):
    """A property of the path that a person should check."""

    code: str
    message: str
    index: int | None = Field(description="Index of the waypoint concerned")


class PathPreviewJson(Json):
    """Properties of a path for the vehicle that would drive it."""

    waypoint_count: int
    length_m: float
    spacing: SpacingJson
    min_radius_m: float | None = Field(description="Radius of the tightest bend; null: straight")
    vehicle_min_radius_m: float
    steerable: bool = Field(description="Whether the vehicle can steer the tightest bend")
    start: StartJson | None = Field(description="null: the pose of the vehicle is unknown")
    approach: ApproachJson | None = Field(
        description="null: the vehicle is on the path, too far from it, or its pose is unknown"
    )
    duration_s: float = Field(
        description="Estimated driving time, standstill to standstill, with the approach"
    )
    warnings: list[PathWarningJson]
    items: list[PointJson] = Field(description=f"At most {MAX_DRAWN} waypoints, to draw the path")

    @classmethod
    def of(cls, view: PathPreview, drawn: list[list[float]]) -> "PathPreviewJson":
        """Show `view`.

        Args:
            view: Properties of the path.
            drawn: Waypoints to draw: x and y in m.
        """
        spacing, start, approach = view.spacing, view.start, view.approach
        return cls(
            waypoint_count=view.waypoint_count,
            length_m=view.length_m,
            spacing=SpacingJson(
                min_m=spacing.min_m, median_m=spacing.median_m, max_m=spacing.max_m
            ),
            min_radius_m=view.min_radius_m,
            vehicle_min_radius_m=view.vehicle_min_radius_m,
            steerable=view.steerable,
            start=(
                None
                if start is None
                else StartJson(
                    distance_m=start.distance_m, heading_error_rad=start.heading_error_rad
                )
            ),
            approach=(
                None
                if approach is None
                else ApproachJson(
                    distance_m=approach.distance_m,
                    turn_rad=approach.turn_rad,
                    speed_mps=approach.speed_mps,
                    length_m=approach.length_m,
                )
            ),
            duration_s=view.duration_s,
            warnings=[
                PathWarningJson(code=item.code, message=item.message, index=item.index)
                for item in view.warnings
            ],
            items=[PointJson(x_m=x, y_m=y) for x, y in drawn],
        )
