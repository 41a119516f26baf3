"""Work on the waypoints of a service call: reading a file, and checking those in a request.

100,000 waypoints take a second, which is not for the event loop.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from domain.arrays import Floats, np
from domain.errors import InvalidValueError
from domain.paths.path import Path
from domain.paths.waypoints import COLUMNS, MAX_WAYPOINTS
from service.files.text_file import decode_csv
from service.files.waypoint_file import read_waypoint_file
from service.files.waypoint_folder import WaypointFolder
from service.ros.interface.message_check import WAYPOINT, checked


@dataclass(frozen=True, slots=True)
class ReadTrack:
    """The path in a waypoint file."""

    path: Path
    warnings: tuple[str, ...]
    """What a person should check."""


def read_track(folder: WaypointFolder, name: str) -> ReadTrack:
    """Read a waypoint file by its name.

    Raises:
        PilothouseError: There is no such file, or its waypoints are no path.
    """
    file = read_waypoint_file(decode_csv(folder.read(name)))
    if file.refusal is not None:
        raise file.refusal
    warnings = tuple(warning.message for warning in file.reading.warnings)
    return ReadTrack(Path(file.waypoints), warnings)


def check_count(waypoints: Sequence[object]) -> None:
    """Reject more waypoints than a path may have, before work is spent on each.

    Raises:
        InvalidValueError: There are too many.
    """
    if len(waypoints) > MAX_WAYPOINTS:
        message = f"a path has 2 to {MAX_WAYPOINTS} waypoints, not {len(waypoints)}"
        raise InvalidValueError(message, "waypoints")


def rows_of(waypoints: Sequence[object]) -> Floats:
    """Return waypoints of a message as rows, shape (n, 3): x m, y m, yaw rad.

    A field that is left out is an error, as over HTTP: its ROS default would be a place.

    Raises:
        InvalidValueError: A field is missing, unknown or no number; `pointer` leads to it.
    """
    rows = [_row(waypoint, f"waypoints/{index}") for index, waypoint in enumerate(waypoints)]
    return np.array(rows, dtype=np.float64).reshape(-1, len(COLUMNS))


def _row(waypoint: object, pointer: str) -> tuple[float, ...]:
    fields = checked(WAYPOINT, waypoint, pointer)
    for name in COLUMNS:
        if name not in waypoint:  # type: ignore[operator]  # it was checked: it is a mapping
            raise InvalidValueError(f"{pointer}/{name} is missing", f"{pointer}/{name}")
    return tuple(fields[name] for name in COLUMNS)
