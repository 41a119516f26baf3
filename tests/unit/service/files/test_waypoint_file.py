"""Waypoint files: what is read of them, and when nobody drives them."""

import math
import sys
import tracemalloc
from collections.abc import Callable
from types import FrameType

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from domain.paths.headings import Heading, wrapped
from service.files.csv_columns import column_names
from service.files.csv_table import MAX_FINDINGS, InvalidWaypointsError
from service.files.text_file import decode_csv
from service.files.waypoint_file import WaypointFile, read_waypoint_file, read_waypoints_csv
from tests.support.field_files import Track, rows
from tests.support.shared import shared_folder

Floats = NDArray[np.float64]


def read(text: str, heading: Heading | None = None, columns: str | None = None) -> Floats:
    return read_waypoints_csv(text, heading, None if columns is None else column_names(columns))


def refused(
    text: str, heading: Heading | None = None, columns: str | None = None
) -> InvalidWaypointsError:
    with pytest.raises(InvalidWaypointsError) as caught:
        read(text, heading, columns)
    return caught.value


def fault(text: str, heading: Heading | None = None) -> tuple[str, int | None]:
    found = refused(text, heading).findings[0]
    return found.code, found.line


def warned(text: str, heading: Heading | None = None, columns: str | None = None) -> list[str]:
    names = None if columns is None else column_names(columns)
    found = read_waypoint_file(text, heading, names)
    return [warning.code for warning in found.reading.warnings]


def csv(places: Floats, headings: Floats) -> str:
    return rows((*places.T, headings), form="%.5f")


def drive(turns: Floats, step_m: float = 0.5, first_rad: float = 0.0) -> tuple[Floats, Floats]:
    """Return places and unwrapped headings of who turns by so much at each step, rad."""
    yaws = first_rad + np.concatenate(([0.0], np.cumsum(turns)))
    middles = (yaws[1:] + yaws[:-1]) / 2
    steps = step_m * np.column_stack((np.cos(middles), np.sin(middles)))
    return np.concatenate((np.zeros((1, 2)), np.cumsum(steps, axis=0))), yaws


def compass(yaws: Floats) -> Floats:
    return np.asarray((90 - np.degrees(yaws)) % 360)


BEND = np.full(100, 0.02)


# --- what is read --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "0,0,0\r\n1,0,0\r\n",
        "0,0,0\r1,0,0\r",
        "0,0,0\n1,0,0",
        "0,0,0\n1,0,0\n\n\n",
        "\n\n0,0,0\n1,0,0\n",
        "0,0,0,2.8,text\n1,0,0,,\n",
        " 0 , 0,0\n1,\t0,0 \n",
        "0;0;0\n1;0;0\n",
        "0\t0\t0\n1\t0\t0\n",
        "  0 0 0\n1  0   0\n",
        "0,0,+0.0\n1.,.0,-0\n",
        "\ufeff0,0,0\r\n1,0,0\r\n",
        "# recorded\n0,0,0\n# halfway\n1,0,0\n",
        "x,y,yaw\n0,0,0\n1,0,0\n",
        "# y; yaw; x\n0;0;0\n0;0;1\n",
        "x,y\n0,0\n1,0\n",
        "0,0\n1,0\n",
        '"x","y","qz","qw"\n"0","0","0","1"\n"1","0","0","2"\n',
    ],
)
def test_a_file_is_the_same_path_however_it_is_written(text: str) -> None:
    assert read(text).tolist() == [[0, 0, 0], [1, 0, 0]]


def test_a_file_in_utf_16_is_read() -> None:
    assert read(decode_csv("x\ty\r\n0\t0\r\n1\t0\r\n".encode("utf-16"))).shape == (2, 3)


def test_headings_of_x_and_y_alone_are_those_of_the_path() -> None:
    track = Track()
    yaws = read(rows((track.x, track.y)))[:, 2]

    assert np.abs(wrapped(yaws - track.yaw))[1:-1].max() < 0.02


def test_a_quaternion_is_a_heading_and_need_not_be_normalised() -> None:
    track = Track()
    parts = [7 * part for part in track.quaternion]
    yaws = read("x,y,qx,qy,qz,qw\n" + rows((track.x, track.y, *parts), form="%.9f"))[:, 2]

    assert np.abs(wrapped(yaws - track.yaw)).max() < 1e-6


def test_a_quaternion_may_roll_and_pitch() -> None:
    # Turned by 90 degrees to the left, then rolled by 60.
    half, roll = math.pi / 4, math.pi / 6
    parts = [
        math.cos(half) * math.sin(roll),
        math.sin(half) * math.sin(roll),
        math.sin(half) * math.cos(roll),
        math.cos(half) * math.cos(roll),
    ]
    row = ",".join(map(str, parts))
    yaws = read(f"x,y,qx,qy,qz,qw\n0,0,{row}\n0,1,{row}\n0,2,{row}\n")[:, 2]

    assert yaws == pytest.approx(math.pi / 2)


def test_coordinates_of_utm_keep_their_millimetres() -> None:
    places = read("500000.123,9999999.456\n500001.123,9999999.457\n")[:, :2]

    assert places.tolist() == [[500000.123, 9999999.456], [500001.123, 9999999.457]]


@settings(max_examples=50)
@given(
    st.lists(
        st.tuples(st.floats(-1e7, 1e7), st.floats(-1e7, 1e7), st.floats(-math.pi, math.pi)),
        min_size=2,
        max_size=2,
    )
)
def test_numbers_are_read_as_they_were_written(points: list[tuple[float, float, float]]) -> None:
    text = "".join(f"{x!r},{y!r},{yaw!r}\r\n" for x, y, yaw in points)

    assert read(text, Heading.RAD, "x,y,yaw").tolist() == [list(point) for point in points]


SEPARATORS = (",", ";", "\t", " ", ", ", "; ")
HEADERS = {
    "x,y,yaw": ("x", "y", "yaw"),
    "# x_m,y_m,psi_rad": ("# x_m", "y_m", "psi_rad"),
    "X [m],Y [m],theta": ('"X [m]"', '"Y [m]"', '"theta"'),
    "pose.position.x,...": ("pose.position.x", "pose.position.y", "HEADING"),
}


@settings(max_examples=150)
@given(
    st.lists(st.floats(-0.2, 0.2), min_size=5, max_size=60),
    st.floats(-1e5, 1e5),
    st.sampled_from(SEPARATORS),
    st.sampled_from(sorted(HEADERS)),
    st.permutations([0, 1, 2]),
    st.sampled_from(["%.6f", "%.6e", "%.9g"]),
    st.sampled_from(["\n", "\r\n", "\r"]),
    st.booleans(),
)
def test_any_path_written_in_any_way_is_read_back(
    turns: list[float],
    offset_m: float,
    separator: str,
    header: str,
    order: list[int],
    form: str,
    end: str,
    has_decimal_comma: bool,
) -> None:
    places, yaws = drive(np.array(turns))
    columns = (places[:, 0] + offset_m, places[:, 1] - offset_m, wrapped(yaws))
    text = rows([columns[index] for index in order], separator, form, end)
    if has_decimal_comma and "," not in separator:
        text = text.replace(".", ",")
    names = [HEADERS[header][index].lstrip("# ") for index in order]
    names[0] = ("# " if header.startswith("#") else "") + names[0]
    found = read_waypoint_file(f"\ufeff{separator.join(names)}{end}{text}")

    digits = 1e-6 if form == "%.6f" else 1e-6 * max(1.0, abs(offset_m))
    assert found.waypoints == pytest.approx(np.column_stack(columns), abs=2 * digits)
    assert found.refusal is None


@pytest.mark.parametrize("encode", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_a_degree_sign_is_read_in_any_encoding(encode: str) -> None:
    track = Track()
    text = "X [m];Y [m];Kurs [°]\n" + rows((track.x, track.y, track.compass), ";")

    assert read(decode_csv(text.encode(encode))).shape == (121, 3)


# --- what columns are ----------------------------------------------------------------------------


def test_asked_columns_decide_whatever_the_header_says() -> None:
    text = "a,b,c\nm,m,m\n9,0,0\n9,1,0\n9,2,0\n"

    assert fault(text) == ("HEADER", 2)
    assert read(text, columns="-,x,y")[:, 0].tolist() == [0, 1, 2]


@pytest.mark.parametrize("columns", ["-,x,y", "_,x,y", "s,x,y", "foo,X,Y", "_,x,y,_"])
def test_a_path_behind_its_distance_is_read_when_told(columns: str) -> None:
    track = Track()
    text = rows((track.s, track.x, track.y, track.one))

    assert fault(text) == ("NOT_A_PATH", 1)
    assert "?columns=s,x,y" in (refused(text).hint or "")
    assert read(text, columns=columns)[:, :2] == pytest.approx(track.places, abs=1e-4)


@pytest.mark.parametrize("scale", [0.05, 0.2, 1.0, 3.0, 20.0])
@pytest.mark.parametrize("first", ["s", "t", "count"])
def test_nobody_drives_along_what_comes_before_x_and_y(scale: float, first: str) -> None:
    track = Track(scale)
    columns = {"s": track.s, "t": track.t, "count": np.arange(121.0)}

    assert fault(rows((columns[first], track.x, track.y), form="%.5f"))[0] == "NOT_A_PATH"


@pytest.mark.parametrize("scale", [0.05, 0.2, 1.0, 3.0, 20.0])
def test_what_comes_behind_x_and_y_is_no_heading(scale: float) -> None:
    track = Track(scale)
    for column in (track.s, track.t, track.speed, track.one * 1.1, track.one * 3.5, track.x):
        assert fault(rows((track.x, track.y, column), form="%.5f"))[0] == "HEADINGS_MISFIT"


def test_a_unit_of_headings_makes_no_path_of_a_distance() -> None:
    track = Track()

    assert fault(rows((track.s, track.x, track.y)), Heading.DEG) == ("NOT_A_PATH", 1)


def test_asked_columns_that_a_file_does_not_have_are_refused() -> None:
    assert refused("0,0\n1,0\n", columns="x,_,y").findings[0].code == "TOO_FEW_COLUMNS"


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("x,y,yaw\n0,0,0\n", ("TOO_FEW_POINTS", 2)),
        ("x,y,yaw\n", ("NO_NUMBERS", 1)),
        ("a,b,c\n0,0,0\n1,0,0\n", ("HEADER", 1)),
        ("x,y,yaw,v\n0,0,0\n1,0,0\n", ("HEADER", 1)),
        ("0\n1\n", ("TOO_FEW_COLUMNS", 1)),
        ("lat,lon\n40,-88\n41,-88\n", ("LATITUDE_LONGITUDE", 1)),
        ("# lat lon\n40 -88\n41 -88\n", ("LATITUDE_LONGITUDE", 1)),
        ("x,y,x\n0,0,0\n1,0,0\n", ("AMBIGUOUS_COLUMNS", 1)),
        ("x_km,y_km\n0,0\n1,0\n", ("WRONG_UNIT", 1)),
        ("x,y,qz,qw\n0,0,0,1\n1,0,0,0\n", ("NO_ROTATION", 3)),
        ("0,0,0\n\n1,0,0\n", ("EMPTY_LINE", 2)),
        ("0,0,0\n1,0\n2,0,0\n", ("TOO_FEW_COLUMNS", 2)),
        ("0,0\n1,0,0\n", ("TOO_MANY_COLUMNS", 2)),
        ("0,0,0\n1,zero,0\n", ("NOT_A_NUMBER", 2)),
        ("0,0,0\nnan,0,0\n", ("NOT_FINITE", 2)),
    ],
)
def test_what_is_no_path_is_refused_with_its_line(text: str, found: tuple[str, int]) -> None:
    assert fault(text) == found


def test_a_header_is_told_once_and_not_line_by_line() -> None:
    error = refused("a;b;c\n" + "0;0;0\n" * 50)

    assert len(error.findings) == 1
    assert "?columns=" in (error.hint or "")


def test_what_stood_there_is_told_in_few_words() -> None:
    assert refused("0,0,0\n1,zero,0\n").message == (
        "the waypoints are invalid: line 2: y: 'zero' is not a number"
    )
    assert len(refused("0,0,0\n1," + "z" * 10_000 + ",0\n").message) < 120


# --- headings ------------------------------------------------------------------------------------


def test_headings_are_converted_when_asked() -> None:
    degrees = read("0,0,90\n0,1,-90\n0,2,270\n", Heading.DEG)[:, 2]
    north = read("0,0,0\n0,1,90\n1,1,180\n1,0,270\n", Heading.COMPASS)[:, 2]

    assert degrees == pytest.approx([math.pi / 2, -math.pi / 2, -math.pi / 2])
    assert np.cos(north) == pytest.approx([0, 1, 0, -1], abs=1e-12)
    assert np.sin(north) == pytest.approx([1, 0, -1, 0], abs=1e-12)


@settings(max_examples=60)
@given(
    st.lists(st.floats(-0.2, 0.2), min_size=20, max_size=80),
    st.floats(-math.pi, math.pi),
    st.sampled_from([np.degrees, compass]),
)
def test_degrees_are_read_as_what_fits_the_path(
    turns: list[float], first_rad: float, convert: Callable[[Floats], Floats]
) -> None:
    places, yaws = drive(np.array(turns), first_rad=first_rad)
    headings = convert(wrapped(yaws))
    # Below, degrees and radians may fit the path alike.
    assume(np.abs(headings).max() > 30.0)
    found = read(csv(places, headings))[:, 2]

    # On a diagonal, degrees from east and from north are the same.
    assert np.median(np.abs(wrapped(found - yaws))) < 0.5


@settings(max_examples=60)
@given(
    st.lists(st.floats(-0.2, 0.2), min_size=5, max_size=80),
    st.floats(-math.pi, math.pi),
    st.floats(0.05, 5.0),
)
def test_radians_are_taken_however_one_drives(
    turns: list[float], first_rad: float, step_m: float
) -> None:
    places, yaws = drive(np.array(turns), step_m, first_rad)

    for radians in (wrapped(yaws), yaws % math.tau):
        assert read(csv(places, radians))[:, 2] == pytest.approx(radians, abs=1e-5)
    assert "HEADINGS_REVERSED" in warned(csv(places, wrapped(yaws + math.pi)))


def test_radians_that_are_counted_on_over_several_turns_are_taken_as_they_are() -> None:
    places, yaws = drive(np.full(1_000, 0.05))

    assert read(csv(places, yaws))[:, 2].max() == pytest.approx(50.0)


@pytest.mark.parametrize("first_rad", [0.0, 1.0, 3.0])
def test_headings_that_nobody_recorded_are_those_of_the_path(first_rad: float) -> None:
    places, yaws = drive(BEND, first_rad=first_rad)
    text = csv(places, np.zeros_like(yaws))

    assert np.abs(wrapped(read(text)[:, 2] - yaws)).max() < 0.05
    assert warned(text) == ["HEADINGS_ZERO"]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("most", [3.1, 360.0])
def test_noise_is_refused_until_somebody_says_what_it_is(seed: int, most: float) -> None:
    places, yaws = drive(np.full(100, 0.06))
    text = csv(places, np.random.default_rng(seed).uniform(-most, most, yaws.shape))
    error = refused(text)

    assert [found.code for found in error.findings] == ["HEADINGS_MISFIT"]
    assert "?columns=x,y" in (error.hint or "")
    assert "?heading=" in (error.hint or "")
    assert read(text, columns="x,y").shape == (101, 3)
    assert warned(text, columns="x,y") == []
    assert warned(text, columns="x,y,yaw") == ["HEADINGS_MISFIT"]
    assert warned(text, Heading.DEG) == ["HEADINGS_MISFIT"]


@pytest.mark.parametrize("off_deg", [-25, 0, 25])
@pytest.mark.parametrize("first_rad", [0.0, 1.0, 2.0, 4.0])
def test_headings_within_30_degrees_of_the_path_are_taken(off_deg: int, first_rad: float) -> None:
    places, yaws = drive(np.full(60, 0.03), first_rad=first_rad)

    assert warned(csv(places, wrapped(yaws + math.radians(off_deg)))) == []


@pytest.mark.parametrize("off_deg", [-90, -45, 35, 90])
def test_headings_further_off_are_refused(off_deg: int) -> None:
    places, yaws = drive(np.full(60, 0.08))

    assert fault(csv(places, wrapped(yaws + math.radians(off_deg))))[0] == "HEADINGS_MISFIT"


def test_the_first_line_whose_heading_is_off_is_named() -> None:
    places, yaws = drive(np.full(100, 0.05))
    yaws = np.where(np.arange(101) < 10, yaws, yaws + math.pi / 2)
    name, line = fault("x,y,yaw_deg\n" + csv(places, np.degrees(wrapped(yaws))))

    assert name == "HEADINGS_MISFIT"
    assert line is not None
    assert line >= 12


def test_two_points_say_too_little_to_doubt_their_heading() -> None:
    assert read("0,0,5\n10,0.875,5\n")[:, 2].tolist() == [5, 5]


# --- anything ------------------------------------------------------------------------------------


def outcome_of(raw: bytes) -> WaypointFile | InvalidWaypointsError:
    try:
        return read_waypoint_file(decode_csv(raw))
    except InvalidWaypointsError as error:
        return error


def assert_answered(raw: bytes) -> None:
    found = outcome_of(raw)
    if isinstance(found, InvalidWaypointsError):
        assert 1 <= len(found.findings) <= MAX_FINDINGS
        assert all(finding.line and len(finding.message) < 300 for finding in found.findings)
        assert found.hint
    else:
        assert np.isfinite(found.waypoints).all()
        assert len(found.waypoints) >= 2
        assert len(found.reading.words) < 2_000


@settings(max_examples=300)
@given(st.binary(max_size=400))
def test_any_bytes_are_a_path_or_are_refused(raw: bytes) -> None:
    assert_answered(raw)


PIECES = st.sampled_from(
    [
        *("0", "1", "2.5", "-3,5", "1e3", "nan", "1e999", "x", "y", "yaw", "qw", "qz", "lat"),
        *(",", ";", "\t", " ", "\n", "\r", "\r\n", "#", "%", '"', "[m]", "\ufeff", "\0", "_", "°"),
    ]
)


@settings(max_examples=500)
@given(st.lists(PIECES, max_size=60))
def test_pieces_of_files_are_a_path_or_are_refused(pieces: list[str]) -> None:
    assert_answered("".join(pieces).encode())


class Work:
    """Counts the calls of functions and the lines that were run."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self, frame: FrameType, event: str, argument: object) -> "Work":
        self.count += 1
        return self


def work_for(text: str) -> int:
    """Return how many lines of Python a file costs."""
    work = Work()
    before = sys.gettrace()
    sys.settrace(work)
    try:
        outcome_of(text.encode())
    finally:
        sys.settrace(before)
    return work.count


LONG = {
    "rows": "0.5,1.5,0.1\n",
    "rows of a spreadsheet": "0,5;1,5;0,1\n",
    "quoted rows": '"0.5","1.5","0.1"\n',
    "columns": "0.5,",
    "names": "x,",
    "empty lines": "\n",
    "comments": "# x,y\n",
    "titles": "x and y\n",
    "blanks": " ",
    "quotes": '"',
    "quotes and commas": '",',
    "faulty rows": "0,zero\n",
    "one number": "9",
    "brackets": "[",
}


@pytest.mark.parametrize("what", LONG)
def test_work_grows_no_faster_than_the_file(what: str) -> None:
    once, twice = work_for("0,0\n" + LONG[what] * 4_000), work_for("0,0\n" + LONG[what] * 8_000)

    assert twice <= 2.2 * once + 2_000


@pytest.mark.parametrize("what", LONG)
def test_a_file_takes_no_more_than_some_times_its_size(what: str) -> None:
    raw = ("0,0\n" + LONG[what] * (1_000_000 // len(LONG[what]))).encode()
    tracemalloc.start()
    try:
        outcome_of(raw)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()

    assert peak < 60 * len(raw)


# --- files from elsewhere ------------------------------------------------------------------------

FILES = {
    "conformance/polaris/fixtures": {
        "blank_line.csv": "EMPTY_LINE",
        "empty.csv": "EMPTY_FILE",
        "header.csv": 2,
        "line_180deg.csv": 61,
        "line_21.csv": 21,
        "line_21_5col.csv": 21,
        "line_21_crlf.csv": 21,
        "line_21_offset.csv": 21,
        "line_90deg.csv": 61,
        "nan.csv": "NOT_FINITE",
        "overlap_loop.csv": 515,
        "short_5m.csv": 21,
        "text.csv": "NOT_A_NUMBER",
        "two_columns.csv": "TOO_FEW_COLUMNS",
    },
    "tracks": {
        "gem_e2_loop.csv": 3822,
        "gem_e2_real_loop_compass_heading.csv": 1279,
        "gem_e2_real_out_and_back.csv": 1170,
    },
}


def outcome(text: str) -> int | str:
    try:
        return len(read(text))
    except InvalidWaypointsError as error:
        return error.findings[0].code


@pytest.mark.parametrize("folder", FILES)
def test_shared_files_are_taken_or_refused_for_what_is_wrong_with_them(folder: str) -> None:
    paths = sorted(shared_folder(folder).glob("*.csv"))

    assert {path.name: outcome(path.read_bytes().decode()) for path in paths} == FILES[folder]


def test_a_shared_recording_with_a_compass_is_read_as_such() -> None:
    path = shared_folder("tracks") / "gem_e2_real_loop_compass_heading.csv"
    text = path.read_bytes().decode()

    assert read_waypoint_file(text).reading.heading is Heading.COMPASS
    assert read(text).tolist() == read(text, Heading.COMPASS).tolist()
