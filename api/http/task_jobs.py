"""Jobs on posted waypoints: parsing, checks, and conversion to a path.

Arguments and results can be pickled, since the worker runs these functions.
"""

from dataclasses import dataclass

from api.http.body_parsing import InvalidBodyError, MalformedBodyError, parse_body
from api.http.schemas.path_preview import MAX_DRAWN, PathPreviewJson
from api.http.schemas.tasks import TaskBody, WaypointJson, WaypointsJson
from domain.arrays import Floats, Integers, np
from domain.errors import InvalidValueError, UnknownControllerError
from domain.paths.approach import ApproachLimits
from domain.paths.headings import Heading
from domain.paths.path import Path
from domain.paths.preview import preview
from domain.tasks.task_planner import check_controller, check_cruise, check_start
from domain.vehicle import Pose
from service.files.csv_reading import CsvReading
from service.files.text_file import decode_csv
from service.files.waypoint_file import read_waypoint_file


@dataclass(frozen=True, slots=True)
class TaskOptions:
    """Query parameters for a CSV; a JSON body holds them itself."""

    controller: str
    speed_mps: float
    start_index: int
    heading: Heading | None = None
    """Unit of the headings; None: the file says it, or the path does."""
    columns: tuple[str, ...] | None = None
    """Names of the columns; None: those in the file, or `x,y[,yaw]`."""


@dataclass(frozen=True, slots=True)
class PostedTask:
    """A posted task with its path."""

    path: Path
    start_index: int
    controller: str
    speed_mps: float
    csv: CsvReading | None = None
    """How the CSV was read; None: the body is JSON."""


def read_posted_task(raw: bytes, csv: TaskOptions | None) -> PostedTask:
    """Return the task that a body describes.

    Args:
        raw: The body.
        csv: Options for a CSV; None: the body is JSON, as described by `TaskBody`.

    Raises:
        PilothouseError: The body or its waypoints are invalid.
    """
    if csv is not None:
        return _read_csv(raw, csv, is_driven=True)
    try:
        return task_of(parse_body(TaskBody, raw))
    except MalformedBodyError as error:
        error.hint = "send a CSV with Content-Type: text/csv"
        raise


def task_of(body: TaskBody) -> PostedTask:
    """Return the task that a validated body describes.

    Raises:
        InvalidBodyError: The waypoints do not form a valid path.
    """
    rows = [(point.x_m, point.y_m, point.yaw_rad) for point in body.waypoints]
    try:
        path = Path(np.array(rows, dtype=np.float64).reshape(-1, 3))
    except InvalidValueError as error:
        raise InvalidBodyError.at(error.pointer or "waypoints", error) from error
    return PostedTask(path, body.start_index, body.controller, body.speed_mps)


def preview_posted(
    raw: bytes,
    csv: TaskOptions | None,
    pose: Pose | None,
    limits: ApproachLimits,
) -> bytes:
    """Return a preview of a task as JSON.

    Args:
        raw: The body.
        csv: As for `read_posted_task`.
        pose: Of the vehicle; None: unknown.
        limits: What the vehicle can do, and from how far it approaches a path.

    Raises:
        PilothouseError: The body or its waypoints are invalid.
    """
    task = read_posted_task(raw, None) if csv is None else _read_csv(raw, csv, is_driven=False)
    try:
        check_controller(task.controller)
        check_start(task.path, task.start_index)
        check_cruise(task.speed_mps, limits.vehicle)
    except UnknownControllerError as error:
        raise InvalidBodyError.at("controller", error) from error
    except InvalidValueError as error:
        raise InvalidBodyError.at(error.pointer, error) from error
    found = preview(task.path, task.speed_mps, pose, limits, task.start_index)
    waypoints = task.path.waypoints
    drawn = waypoints[thinned(len(waypoints), MAX_DRAWN), :2].tolist()
    return PathPreviewJson.of(found, drawn, task.csv).model_dump_json().encode()


def _read_csv(raw: bytes, csv: TaskOptions, *, is_driven: bool) -> PostedTask:
    """Return the task of a CSV.

    Args:
        raw: The body.
        csv: Its options.
        is_driven: Whether headings have to fit the path, unless somebody said what they are.

    Raises:
        InvalidWaypointsError: The file is invalid.
    """
    file = read_waypoint_file(decode_csv(raw), csv.heading, csv.columns)
    if is_driven and file.refusal is not None:
        raise file.refusal
    path = Path(file.waypoints)
    return PostedTask(path, csv.start_index, csv.controller, csv.speed_mps, file.reading)


def encode_waypoints(waypoints: Floats, max_points: int | None) -> bytes:
    """Return waypoints as JSON.

    Args:
        waypoints: Shape (n, 3): x and y in m, yaw in rad.
        max_points: Most waypoints, evenly spread, including the first and last; None: all.
    """
    indices = thinned(len(waypoints), max_points)
    items = [WaypointJson(x_m=x, y_m=y, yaw_rad=yaw) for x, y, yaw in waypoints[indices].tolist()]
    return (
        WaypointsJson(waypoint_count=len(waypoints), indices=indices.tolist(), items=items)
        .model_dump_json()
        .encode()
    )


def thinned(count: int, max_points: int | None) -> Integers:
    """Return indices of at most `max_points` of `count` things, evenly spread."""
    if max_points is None or count <= max_points:
        return np.arange(count)
    return np.unique(np.linspace(0, count - 1, max_points).round().astype(int))
