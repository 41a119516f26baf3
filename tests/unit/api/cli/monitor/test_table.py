from collections.abc import Sequence

from api.cli.monitor.table import Column, Layout, printable, table

NAME_AND_STATE = (Column("name", least=4), Column("state", least=5))


def drawn(columns: Sequence[Column], *rows: tuple[str, ...], width: int = 80) -> list[str]:
    return [line.plain for line in table(columns, [(row, "") for row in rows], width)]


def test_columns_are_as_wide_as_what_is_in_them() -> None:
    assert drawn(NAME_AND_STATE, ("manipulator", "active"), ("arm", "inactive")) == [
        "name        state",
        "manipulator active",
        "arm         inactive",
    ]


def test_what_is_too_long_is_cut_with_an_ellipsis_the_widest_first() -> None:
    lines = drawn(NAME_AND_STATE, ("a_very_long_name", "active"), width=14)

    assert lines == ["name    state", "a_very… active"]


def test_a_column_is_not_cut_below_its_least() -> None:
    lines = drawn(
        (Column("name", least=4), Column("state", least=9)), ("longer", "long_state"), width=5
    )

    assert lines[1] == "lon… long_sta…"


def test_a_column_keeps_its_usual_width_where_there_is_room() -> None:
    columns = (Column("name", least=4, usual=10), Column("state", least=5))

    assert drawn(columns, ("arm", "active"))[1] == "arm        active"
    assert drawn(columns, ("arm", "active"), width=12)[1] == "arm   active"


def test_a_column_is_left_out_where_the_terminal_is_too_narrow() -> None:
    columns = (Column("name", least=4), Column("note", least=4, needs_width=40))

    assert drawn(columns, ("arm", "calm"), width=40)[1] == "arm  calm"
    assert drawn(columns, ("arm", "calm"), width=39)[1] == "arm"


def test_wide_characters_take_two_cells() -> None:
    assert drawn(NAME_AND_STATE, ("機械腕", "active"))[1] == "機械腕 active"
    assert drawn(NAME_AND_STATE, ("機械腕", "active"), width=12)[1] == "機械… active"


def test_a_name_cannot_move_the_cursor() -> None:
    assert printable("arm\x1b[2J\r\n") == "arm?[2J??"
    assert drawn(NAME_AND_STATE, ("arm\x1b[2J", "active"))[1] == "arm?[2J active"


def test_each_row_has_its_style() -> None:
    titles, row = table(NAME_AND_STATE, [(("arm", "active"), "bold red")], 80, "underline")

    assert (titles.style, row.style) == ("underline", "bold red")


def test_cells_of_a_column_may_be_aligned_to_the_right() -> None:
    columns = (Column("name", least=4, usual=8, is_right=True), Column("state", least=5))

    assert drawn(columns, ("arm", "active")) == ["    name state", "     arm active"]


def test_a_title_may_span_several_columns_also_where_one_is_left_out() -> None:
    columns = (
        Column("name", least=4),
        Column("target", least=4, needs_width=30, is_right=True),
        Column("actual", least=4, is_right=True),
    )
    above = [("part", (0,)), ("state", (1, 2))]
    rows = [("name", "target", "actual"), ("arm", "active", "off")]
    wide, narrow = (Layout(columns, rows, width, " | ") for width in (30, 29))

    assert wide.spanning(above).plain == "part |           state"
    assert wide.line(rows[1]).plain == "arm  | active |    off"
    assert wide.width == 22
    assert narrow.spanning(above).plain == "part |  state"
    assert narrow.width == 13
