import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.files.waypoint_file import (
    MAX_FINDINGS,
    Heading,
    InvalidWaypointsError,
    read_waypoints_csv,
)
from tests.support.shared import shared_folder

Floats = NDArray[np.float64]


def refused(text: str, heading: Heading = Heading.RAD) -> InvalidWaypointsError:
    with pytest.raises(InvalidWaypointsError) as caught:
        read_waypoints_csv(text, heading)
    return caught.value


def faults(text: str) -> list[tuple[str, int | None, int | None]]:
    return [(fault.code, fault.line, fault.column) for fault in refused(text).findings]


def csv(places: Floats, headings: Floats) -> str:
    rows = np.column_stack((places, headings)).tolist()
    return "".join(f"{x:.3f},{y:.3f},{heading:.5f}\n" for x, y, heading in rows)


def drive(turns: Floats, step_m: float = 0.5, first_rad: float = 0.0) -> tuple[Floats, Floats]:
    """Return places and unwrapped headings of who turns by so much at each step, rad."""
    yaws = first_rad + np.concatenate(([0.0], np.cumsum(turns)))
    middles = (yaws[1:] + yaws[:-1]) / 2
    steps = step_m * np.column_stack((np.cos(middles), np.sin(middles)))
    return np.concatenate((np.zeros((1, 2)), np.cumsum(steps, axis=0))), yaws


def compass(yaws: Floats) -> Floats:
    return np.asarray((90 - np.degrees(yaws)) % 360)


def half_turns(angles: Floats) -> Floats:
    return np.asarray((angles + math.pi) % math.tau - math.pi)


BEND = np.full(100, 0.02)


# --- what is taken -------------------------------------------------------------------------------


def test_each_line_is_a_waypoint() -> None:
    assert read_waypoints_csv("0,1,0.5\n-2.5,1e1,-3\n").tolist() == [[0, 1, 0.5], [-2.5, 10, -3]]


@pytest.mark.parametrize(
    "text",
    [
        "0,0,0\r\n1,0,0\r\n",
        "0,0,0\n1,0,0",
        "0,0,0\n1,0,0\n\n\n",
        "0,0,0\r\n1,0,0\r\n\r\n \r\n",
        "0,0,0,2.8,text\n1,0,0,,\n",
        " 0 , 0,0\n1,\t0,0 \n",
        "0,0,+0.0\n1.,.0,-0\n",
        "\ufeff0,0,0\r\n1,0,0\r\n",
    ],
)
def test_line_ends_blanks_and_further_columns_make_no_difference(text: str) -> None:
    assert read_waypoints_csv(text).tolist() == [[0, 0, 0], [1, 0, 0]]


def test_a_hundred_thousand_waypoints_are_taken() -> None:
    text = "".join(f"{index},0,0\n" for index in range(100_000))

    assert read_waypoints_csv(text).shape == (100_000, 3)


@settings(max_examples=50)
@given(
    st.lists(
        st.tuples(st.floats(-1e7, 1e7), st.floats(-1e7, 1e7), st.floats(-math.pi, math.pi)),
        min_size=2,
        max_size=3,
    )
)
def test_numbers_are_read_as_they_were_written(rows: list[tuple[float, float, float]]) -> None:
    # Of so few points nothing can be said about their headings.
    text = "".join(f"{x!r},{y!r},{yaw!r}\r\n" for x, y, yaw in rows)

    assert read_waypoints_csv(text).tolist() == [list(row) for row in rows]


# --- what is refused -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("", [("EMPTY_FILE", 1, 1)]),
        ("\n\n", [("EMPTY_FILE", 1, 1)]),
        (" \r\n", [("EMPTY_FILE", 1, 1)]),
        ("\ufeff", [("EMPTY_FILE", 1, 1)]),
        ("\n0,0,0\n1,0,0\n", [("EMPTY_LINE", 1, 1)]),
        ("0,0,0\n1,0,0\n , ,\n", [("NOT_A_NUMBER", 3, k) for k in (2, 4, 5)]),
        ("0,0,0\n", [("TOO_FEW_POINTS", 1, 1)]),
        ("0,0,0\n\n1,0,0\n", [("EMPTY_LINE", 2, 1)]),
        ("x,y,yaw\n0,0,0\n1,0,0\n", [("HEADER", 1, 1)]),
        ("x,y,yaw\n", [("HEADER", 1, 1)]),
        ("# recorded\n0,0,0\n1,0,0\n", [("HEADER", 1, 1)]),
        ("0,0,0\nx,y,yaw\n1,0,0\n", [("NOT_A_NUMBER", 2, k) for k in (1, 3, 5)]),
        ("0,0,0\n1,zero,0\n", [("NOT_A_NUMBER", 2, 3)]),
        ("0,0,0\n1,  zero,0\n", [("NOT_A_NUMBER", 2, 5)]),
        ("0,0,0\n1,,0\n", [("NOT_A_NUMBER", 2, 3)]),
        ("0,0,0\n1,0\n2,0,0\n", [("TOO_FEW_COLUMNS", 2, 1)]),
        ("0;0;0\n1;0;0\n", [("HEADER", 1, 1), ("TOO_FEW_COLUMNS", 2, 1)]),
        ("nan,0,0\n1,0,0\n", [("NOT_FINITE", 1, 1)]),
        ("0,0,-inf\n1,0,1e999\n", [("NOT_FINITE", 1, 5), ("NOT_FINITE", 2, 5)]),
        ("0,0,0\n1,-10000001,0\n", [("TOO_FAR", 2, 3)]),
        ("0,1_0,0\n1,0,0\n", [("NOT_A_NUMBER", 1, 3)]),
        ("0,\u0661,0\n1,0,0\n", [("NOT_A_NUMBER", 1, 3)]),
        ("0,0,0\r1,0,0\r", [("NOT_A_NUMBER", 1, 5)]),
    ],
)
def test_what_is_no_waypoint_is_told_with_its_place(
    text: str, found: list[tuple[str, int, int]]
) -> None:
    assert faults(text) == found


def test_what_stood_there_is_told() -> None:
    error = refused("0,0,0\n1,zero,0\n")

    assert error.code == "INVALID_WAYPOINTS"
    assert error.message == "the waypoints are invalid: line 2: y: 'zero' is not a number"
    assert error.hint is not None
    assert "x,y,yaw" in error.hint


def test_what_stood_there_is_not_told_at_any_length() -> None:
    assert len(refused("0,0,0\n1," + "z" * 10_000 + ",0\n").message) < 120


def test_faults_of_every_kind_come_in_the_order_of_the_file() -> None:
    assert faults("0,0,0\n1,nan,0\n2,x,0\n3,0\n4,2e7,0\n") == [
        ("NOT_FINITE", 2, 3),
        ("NOT_A_NUMBER", 3, 3),
        ("TOO_FEW_COLUMNS", 4, 1),
        ("TOO_FAR", 5, 3),
    ]


@pytest.mark.parametrize("line", ["a,b,c", "1,0", "", "nan,nan,nan"])
def test_no_more_faults_are_told_than_anybody_reads(line: str) -> None:
    text = "0,0,0\n" + f"{line}\n" * 1_000 + "1,0,0\n"

    assert len(refused(text).findings) == MAX_FINDINGS


def test_more_than_a_hundred_thousand_waypoints_are_refused() -> None:
    assert faults("0,0,0\n" * 100_001) == [("TOO_MANY_POINTS", 100_001, 1)]


# --- headings that are no radians ----------------------------------------------------------------


def test_degrees_are_converted_when_asked() -> None:
    waypoints = read_waypoints_csv("0,0,90\n0,1,-90\n0,2,270\n", Heading.DEG)

    assert waypoints[:, 2] == pytest.approx([math.pi / 2, -math.pi / 2, -math.pi / 2])


def test_headings_of_a_compass_are_converted_when_asked() -> None:
    waypoints = read_waypoints_csv("0,0,0\n0,1,90\n1,1,180\n1,0,270\n", Heading.COMPASS)

    assert np.cos(waypoints[:, 2]) == pytest.approx([0, 1, 0, -1], abs=1e-12)
    assert np.sin(waypoints[:, 2]) == pytest.approx([1, 0, -1, 0], abs=1e-12)


def test_degrees_given_as_radians_are_refused_with_the_way_to_say_so() -> None:
    places, yaws = drive(BEND)
    error = refused(csv(places, np.degrees(yaws)))

    assert [(fault.code, fault.line) for fault in error.findings] == [("NOT_RADIANS", 7)]
    assert (error.hint or "").startswith("set ?heading=deg ")


def test_headings_of_a_compass_given_as_radians_are_refused_with_the_way_to_say_so() -> None:
    places, yaws = drive(BEND)
    error = refused(csv(places, compass(yaws)))

    assert [(fault.code, fault.line) for fault in error.findings] == [("NOT_RADIANS", 1)]
    assert (error.hint or "").startswith("set ?heading=compass ")


@pytest.mark.parametrize("convert", [np.degrees, compass], ids=["degrees", "compass"])
@pytest.mark.parametrize("first_rad", [0.2, 1.2, math.pi, -math.pi / 2])
def test_a_straight_in_degrees_is_refused_whichever_way_it_leads(
    convert: Callable[[Floats], Floats], first_rad: float
) -> None:
    places, yaws = drive(np.zeros(60), first_rad=first_rad)

    assert refused(csv(places, convert(yaws))).findings[0].code == "NOT_RADIANS"


@pytest.mark.parametrize(
    ("convert", "way_deg"), [(np.degrees, 5.0), (compass, 86.0)], ids=["degrees", "compass"]
)
def test_degrees_within_a_turn_of_radians_are_refused_where_they_alone_fit(
    convert: Callable[[Floats], Floats], way_deg: float
) -> None:
    places, yaws = drive(np.zeros(60), first_rad=math.radians(way_deg))
    error = refused(csv(places, convert(yaws)))

    assert [(fault.code, fault.line) for fault in error.findings] == [("NOT_RADIANS", 1)]


@pytest.mark.parametrize("seed", range(10))
def test_headings_of_more_than_a_turn_that_fit_as_nothing_are_refused(seed: int) -> None:
    places, yaws = drive(BEND)
    headings = np.random.default_rng(seed).uniform(0.0, 360.0, yaws.shape)

    assert refused(csv(places, headings)).findings[0].code == "NOT_RADIANS"


def test_standing_still_with_a_heading_of_many_turns_is_refused() -> None:
    assert faults("1,1,90\n1,1,90\n1,1,90\n") == [("NOT_RADIANS", 1, 5)]


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

    read_waypoints_csv(csv(places, half_turns(yaws)))
    # From 0 to a full turn, counted on, and backwards.
    read_waypoints_csv(csv(places, yaws % math.tau))
    read_waypoints_csv(csv(places, yaws))
    read_waypoints_csv(csv(places, half_turns(yaws + math.pi)))


def test_radians_that_are_counted_on_over_several_turns_are_taken_as_they_are() -> None:
    places, yaws = drive(np.full(1_000, 0.05))

    assert read_waypoints_csv(csv(places, yaws))[:, 2].max() == pytest.approx(50.0)


@settings(max_examples=40)
@given(st.floats(-math.pi, math.pi), st.floats(-0.1, 0.1))
def test_headings_that_nobody_recorded_are_taken(first_rad: float, turn: float) -> None:
    places, yaws = drive(np.full(60, turn), first_rad=first_rad)

    read_waypoints_csv(csv(places, np.zeros_like(yaws)))


@pytest.mark.parametrize("slip_rad", [-math.pi / 2, -0.8, 0.5, math.pi / 2])
@pytest.mark.parametrize("first_rad", [0.0, 1.0, math.pi / 2, math.pi])
def test_a_vehicle_that_drifts_sideways_is_taken(first_rad: float, slip_rad: float) -> None:
    places, yaws = drive(np.zeros(60), first_rad=first_rad)

    read_waypoints_csv(csv(places, half_turns(yaws + slip_rad)))


def test_a_vehicle_that_backs_up_is_taken_although_its_heading_would_fit_as_degrees() -> None:
    places, yaws = drive(np.zeros(60), first_rad=0.05)

    # 3.19 rad is the way, backwards; 3.19 degrees are 0.056 rad.
    read_waypoints_csv(csv(places, yaws + math.pi))


@settings(max_examples=40)
@given(
    st.floats(-math.pi, math.pi),
    st.floats(-0.1, 0.1),
    st.floats(0.0, 1.0),
    st.integers(0, 1_000),
)
def test_a_noisy_heading_is_taken(
    first_rad: float, turn: float, noise_rad: float, seed: int
) -> None:
    places, yaws = drive(np.full(60, turn), first_rad=first_rad)
    noise = np.random.default_rng(seed).normal(0.0, noise_rad, yaws.shape)

    read_waypoints_csv(csv(places, half_turns(yaws + noise)))


@pytest.mark.parametrize("convert", [np.degrees, compass], ids=["degrees", "compass"])
@pytest.mark.parametrize("length_m", [0.4, 5.0])
def test_a_short_path_in_degrees_is_refused(
    convert: Callable[[Floats], Floats], length_m: float
) -> None:
    places, yaws = drive(np.full(20, 0.05), length_m / 20, first_rad=0.4)

    assert refused(csv(places, convert(yaws))).findings[0].code == "NOT_RADIANS"


@settings(max_examples=60)
@given(
    st.lists(st.floats(-0.2, 0.2), min_size=20, max_size=80),
    st.floats(-math.pi, math.pi),
    st.sampled_from([np.degrees, compass]),
)
def test_headings_of_more_than_a_turn_are_refused_in_any_unit_but_radians(
    turns: list[float], first_rad: float, convert: Callable[[Floats], Floats]
) -> None:
    places, yaws = drive(np.array(turns), first_rad=first_rad)
    headings = convert(half_turns(yaws))
    # Below, degrees and radians may fit the way alike.
    assume(np.abs(headings).max() > 30.0)

    assert refused(csv(places, headings)).findings[0].code == "NOT_RADIANS"


@settings(max_examples=40)
@given(
    st.lists(st.floats(-0.2, 0.2), min_size=5, max_size=80),
    st.floats(-math.pi, math.pi),
    st.sampled_from([(np.degrees, Heading.DEG), (compass, Heading.COMPASS)]),
)
def test_headings_whose_unit_is_told_lead_along_the_way(
    turns: list[float],
    first_rad: float,
    unit: tuple[Callable[[Floats], Floats], Heading],
) -> None:
    places, yaws = drive(np.array(turns), first_rad=first_rad)
    convert, heading = unit
    read = read_waypoints_csv(csv(places, convert(yaws)), heading)

    assert np.abs(read[:, 2]).max() <= math.pi
    assert half_turns(read[:, 2] - yaws) == pytest.approx(0.0, abs=1e-6)


def test_two_points_say_too_little_to_doubt_their_heading() -> None:
    read_waypoints_csv("0,0,5\n10,0.875,5\n")


def test_a_vehicle_that_stands_still_and_whose_heading_is_noise_is_taken() -> None:
    random = np.random.default_rng(1)
    places = random.normal(0.0, 0.01, (500, 2))

    read_waypoints_csv(csv(places, random.uniform(-math.pi, math.pi, 500)))


# --- files from elsewhere ------------------------------------------------------------------------

FILES = {
    "conformance/polaris/fixtures": {
        "blank_line.csv": "EMPTY_LINE",
        "empty.csv": "EMPTY_FILE",
        "header.csv": "HEADER",
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
        "gem_e2_real_loop_compass_heading.csv": "NOT_RADIANS",
        "gem_e2_real_out_and_back.csv": 1170,
    },
}


def outcome(text: str, heading: Heading = Heading.RAD) -> int | str:
    try:
        return len(read_waypoints_csv(text, heading))
    except InvalidWaypointsError as error:
        return error.findings[0].code


@pytest.mark.parametrize("folder", FILES)
def test_shared_files_are_taken_or_refused_for_what_is_wrong_with_them(folder: str) -> None:
    paths = sorted(shared_folder(folder).glob("*.csv"))

    assert {path.name: outcome(path.read_bytes().decode()) for path in paths} == FILES[folder]


def test_a_shared_recording_with_a_compass_fits_its_way_once_that_is_said() -> None:
    path = shared_folder("tracks") / "gem_e2_real_loop_compass_heading.csv"
    error = refused(path.read_bytes().decode())
    waypoints = read_waypoints_csv(path.read_bytes().decode(), Heading.COMPASS)

    assert (error.hint or "").startswith("set ?heading=compass ")
    assert outcome(csv(waypoints[:, :2], waypoints[:, 2])) == 1279
