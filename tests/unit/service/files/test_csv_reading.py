"""How a file was read, in words."""

import pytest

from service.files.csv_reading import MAX_SHOWN, CsvReading
from service.files.waypoint_file import read_waypoint_file


def reading(text: str, columns: str | None = None) -> CsvReading:
    names = None if columns is None else tuple(columns.split(","))
    return read_waypoint_file(text, columns=names).reading


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "0,0\n1,0\n2,0",
            "comma-separated: x from column 1, y from column 2, headings from the path",
        ),
        (
            "# s_m; x_m; y_m; psi_rad\n0;0;0;0\n1;1;0;0\n2;2;0;0",
            "semicolon-separated, named in line 1: x from x_m (column 2), y from y_m (column 3),"
            " heading from psi_rad (column 4), radians counter-clockwise from east; not used: s_m",
        ),
        (
            "0,0;0;0\n1,5;0;0\n2,5;0;0",
            "semicolon-separated, with decimal commas: x from column 1, y from column 2,"
            " heading from column 3, radians counter-clockwise from east",
        ),
        (
            "x y qz qw\n0 0 0 1\n1 0 0 1\n2 0 0 1",
            "blank-separated, named in line 1: x from x (column 1), y from y (column 2),"
            " heading from the quaternion in columns 3, 4",
        ),
        (
            "0\t0\t90\t7\n0\t1\t90\t7\n0\t2\t90\t7",
            "tab-separated: x from column 1, y from column 2, heading from column 3,"
            " degrees counter-clockwise from east; not used: 4",
        ),
        (
            "0,0,2\n1,0,2\n2,0,2",
            "comma-separated: x from column 1, y from column 2, heading from column 3,"
            " degrees counter-clockwise from east",
        ),
    ],
)
def test_a_sentence_tells_separator_and_columns(text: str, words: str) -> None:
    assert reading(text).words == words


def test_names_that_were_asked_are_told_by_their_columns() -> None:
    assert reading("9,0,0\n9,1,0\n9,2,0", "s,x,y").words == (
        "comma-separated: x from column 2, y from column 3, headings from the path; not used: s"
    )


def test_a_column_without_a_name_is_told_by_its_number() -> None:
    assert reading("9,0,0,7\n9,1,0,7\n9,2,0,7", "_,x,y").words.endswith("not used: 1, 4")


def test_each_column_has_its_meaning_and_unit() -> None:
    columns = reading("x_m,y_m,heading,vx_mps,flag\n0,0,90,1,0\n0,1,90,1,0\n0,2,90,1,0").columns

    assert [(c.name, c.meaning, c.used, c.unit) for c in columns] == [
        ("x_m", "x", True, "m"),
        ("y_m", "y", True, "m"),
        ("heading", "yaw", True, "deg"),
        ("vx_mps", "speed", False, "mps"),
        ("flag", None, False, None),
    ]


def test_of_many_columns_the_first_are_told_and_the_others_counted() -> None:
    row = ",".join(["0"] * 900)
    found = reading(f"0,0,{row}\n1,0,{row}\n2,0,{row}")

    assert (len(found.columns), found.column_count) == (MAX_SHOWN, 902)
    assert found.words.endswith("not used: 4, 5, 6, 7, 8, 9, 10, 11 and 891 more")
