"""Each kind of public waypoint file, and what it is read as.

The kinds are made by `tests/support/field_files.py`; `docs/how-to/waypoint-files.md` tells of them.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from domain.paths.headings import Heading, wrapped
from service.files.csv_columns import column_names
from service.files.csv_table import InvalidWaypointsError
from service.files.text_file import decode_csv
from service.files.waypoint_file import WaypointFile, read_waypoint_file
from tests.support import field_files
from tests.support.field_files import FIELD_FILES, Track


@dataclass(frozen=True)
class Read:
    """What a file is read as: `x` and `y` are columns from 1."""

    separator: str
    x: int = 1
    y: int = 2
    headings: str = "path"
    """`path`, `quaternion`, or the unit of the column."""
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Refused:
    """Why a file is refused, and the columns that make a path of it; empty: none do."""

    code: str
    columns: str
    hint: str = ""


KINDS: dict[str, Read | Refused] = {
    # planners
    "racetrack_centre_line": Read("comma"),
    "racetrack_race_line": Read("semicolon", 2, 3, "rad_north"),
    "reference_with_normals": Read("semicolon", headings="rad_north"),
    "small_centre_line": Read("comma"),
    "race_line_without_names": Refused("NOT_A_PATH", "s,x,y", "?columns=s,x,y"),
    "planner_trajectory": Read("comma", headings="rad"),
    "highway_map": Refused("HEADINGS_MISFIT", "x,y", "?columns=x,y"),
    "highway_map_with_names": Read("blank"),
    "places_only": Read("comma"),
    "course_of_a_tutorial": Read("comma"),
    # recorders
    "recorded_radians": Read("comma", headings="rad"),
    "recorded_degrees": Read("comma", headings="deg"),
    "recorded_compass": Read("comma", headings="compass"),
    "named_compass": Read("comma", headings="compass"),
    "recorded_in_reverse": Read("comma", headings="rad", warnings=("HEADINGS_REVERSED",)),
    "topic_as_csv": Read("comma", 4, 5, "quaternion"),
    "poses_as_csv": Read("comma", 2, 3, "quaternion"),
    "slam_trajectory": Read("blank", 2, 3, "quaternion"),
    "slam_trajectory_without_names": Refused(
        "NOT_A_PATH", "time,x,y,z,qx,qy,qz,qw", "?columns=time,x,y,z,qx,qy,qz,qw"
    ),
    "flight_state": Read("comma", 2, 3, "quaternion"),
    "matrix_poses": Refused("NOT_A_PATH", "_,_,_,x,_,_,_,_,_,_,_,y", "3x4"),
    # spreadsheets and others
    "tabs": Read("tab", headings="rad"),
    "spreadsheet": Read("semicolon", headings="deg"),
    "old_macintosh": Read("comma", headings="rad"),
    "quoted": Read("comma", headings="rad"),
    "exponents": Read("blank", 3, 2, "rad"),
    "distances_first": Refused("NOT_A_PATH", "s,x,y", "?columns=s,x,y"),
    "small_distances_first": Refused("NOT_A_PATH", "s,x,y", "?columns=s,x,y"),
    "counts_first": Refused("NOT_A_PATH", "i,x,y", "?columns=t,x,y"),
    "times_first": Refused("NOT_A_PATH", "t,x,y", "?columns=t,x,y"),
    "widths": Refused("HEADINGS_MISFIT", "x,y,width", "?columns=x,y"),
    "speeds": Refused("HEADINGS_MISFIT", "x,y,speed", "?columns=x,y"),
    "times": Refused("HEADINGS_MISFIT", "x,y,t", "?columns=x,y"),
    "utm": Read("comma", headings="rad"),
    "named_degrees_of_latitude": Refused("LATITUDE_LONGITUDE", "", "UTM"),
    "degrees_of_latitude": Refused("NOT_A_PATH", "", "UTM"),
    "no_headings_recorded": Read("comma", warnings=("HEADINGS_ZERO",)),
}


def track_of(kind: Callable[[], str]) -> Track:
    scales = {
        field_files.small_centre_line: 0.2,
        field_files.race_line_without_names: 0.2,
        field_files.counts_first: 0.2,
        field_files.small_distances_first: 0.1,
    }
    return Track(scales.get(kind, 1.0))


def assert_track(found: WaypointFile, track: Track) -> None:
    places = found.waypoints[:, :2]
    off = places - track.places
    # UTM is somewhere else, and rounded to 1 mm.
    assert np.abs(off - off[0]).max() < 2e-3
    backwards = "HEADINGS_REVERSED" in [w.code for w in found.reading.warnings]
    errors = np.abs(wrapped(found.waypoints[:, 2] - track.yaw - np.pi * backwards))
    assert np.median(errors) < 0.05


@pytest.mark.parametrize("kind", FIELD_FILES, ids=lambda kind: kind.__name__)
def test_a_file_of_the_field_is_read_as_what_it_is_or_refused_with_what_to_say(
    kind: Callable[[], str],
) -> None:
    expected, text = KINDS[kind.__name__], kind()
    if isinstance(expected, Read):
        found = read_waypoint_file(text)
        reading = found.reading
        places = {str(c.meaning): n for n, c in enumerate(reading.columns, 1) if c.used}
        quaternion = "quaternion" if reading.columns_are_rotations else None
        headings = "path" if reading.headings_from_path else reading.heading or quaternion
        warnings = tuple(warning.code for warning in reading.warnings)

        read = Read(reading.separator, places["x"], places["y"], str(headings), warnings)

        assert found.refusal is None
        assert read == expected
        assert_track(found, track_of(kind))
        return
    refusal = refusal_of(text)
    assert refusal.findings[0].code == expected.code
    assert expected.hint in f"{refusal.message} {refusal.hint}"
    if expected.columns:
        told = read_waypoint_file(text, columns=column_names(expected.columns))
        assert told.refusal is None
        assert_track(told, track_of(kind))


def refusal_of(text: str) -> InvalidWaypointsError:
    try:
        refusal = read_waypoint_file(text).refusal
    except InvalidWaypointsError as error:
        return error
    assert refusal is not None
    return refusal


def test_every_kind_is_expected_to_be_something() -> None:
    assert {kind.__name__ for kind in FIELD_FILES} == set(KINDS)


@pytest.mark.parametrize("kind", FIELD_FILES, ids=lambda kind: kind.__name__)
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_encoding_and_line_ends_make_no_difference(kind: Callable[[], str], encoding: str) -> None:
    text = kind().removeprefix("\ufeff")
    lines = text.replace("\r\n", "\n").replace("\r", "\n")
    other = decode_csv(lines.replace("\n", "\r\n").encode(encoding))

    assert answer_to(other) == answer_to(text)


def answer_to(text: str) -> object:
    try:
        return read_waypoint_file(text).reading
    except InvalidWaypointsError as error:
        return error.message


@pytest.mark.parametrize("unit", list(Heading))
def test_headings_in_any_unit_are_told_by_that_unit(unit: Heading) -> None:
    track = Track()
    turned = {
        Heading.RAD: track.yaw,
        Heading.DEG: np.degrees(track.yaw),
        Heading.COMPASS: track.compass,
        Heading.RAD_NORTH: track.psi,
        Heading.RAD_COMPASS: np.radians(track.compass),
    }
    text = "x,y,heading\n" + field_files.rows((track.x, track.y, turned[unit]))

    assert read_waypoint_file(text).reading.heading is unit
