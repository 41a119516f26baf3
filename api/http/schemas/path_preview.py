"""The preview of a path as clients see it."""

from pydantic import Field

from api.http.schemas.base import Json
from api.http.schemas.tasks import PointJson
from domain.paths.preview import PathPreview
from service.files.csv_reading import MAX_SHOWN, CsvReading

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
    hint: str | None = Field(
        default=None, description="What to do; a task is rejected until it is done"
    )


class ColumnJson(Json):
    """How one column of a CSV was read."""

    name: str | None = Field(description="In the file, or in `?columns=`")
    meaning: str | None = Field(
        description="`x`, `y`, `yaw`, `qx`, ..., or what an unused column holds; null: unknown"
    )
    used: bool
    unit: str | None = Field(
        description="`m`, or that of the heading: `rad`, `deg`, `compass`, and `rad_north` or"
        " `rad_compass` for radians from north"
    )


class CsvJson(Json):
    """How a CSV was read."""

    separator: str = Field(description="`comma`, `semicolon`, `tab` or `blank`")
    decimal: str = Field(description="`point` or `comma`")
    header_line: int | None = Field(description="The line that names the columns, from 1")
    columns: list[ColumnJson] = Field(description=f"The first {MAX_SHOWN} of them")
    column_count: int
    heading: str | None = Field(
        description="Unit of the headings; null: none, quaternions, or not clear"
    )
    headings_from: str = Field(description="`column`, `quaternion` or `path`")
    message: str = Field(description="The same in words")

    @classmethod
    def of(cls, reading: CsvReading) -> "CsvJson":
        """Show how a file was read."""
        origin = "quaternion" if reading.columns_are_rotations else "column"
        return cls(
            separator=reading.separator,
            decimal="comma" if reading.has_decimal_comma else "point",
            header_line=reading.header_line,
            columns=[
                ColumnJson(
                    name=column.name, meaning=column.meaning, used=column.used, unit=column.unit
                )
                for column in reading.columns
            ],
            column_count=reading.column_count,
            heading=reading.heading,
            headings_from="path" if reading.headings_from_path else origin,
            message=reading.words,
        )


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
    csv: CsvJson | None = Field(
        default=None, description="How the CSV was read; null: the waypoints were JSON"
    )
    items: list[PointJson] = Field(description=f"At most {MAX_DRAWN} waypoints, to draw the path")

    @classmethod
    def of(
        cls, view: PathPreview, drawn: list[list[float]], csv: CsvReading | None = None
    ) -> "PathPreviewJson":
        """Show `view`.

        Args:
            view: Properties of the path.
            drawn: Waypoints to draw: x and y in m.
            csv: How the CSV was read; None: the waypoints were JSON.
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
                PathWarningJson(
                    code=item.code, message=item.message, index=item.index, hint=item.hint
                )
                for item in (*(csv.warnings if csv else ()), *view.warnings)
            ],
            csv=None if csv is None else CsvJson.of(csv),
            items=[PointJson(x_m=x, y_m=y) for x, y in drawn],
        )
