import pytest

from tests.support.tables import table, text_table


def cases_of(mark: pytest.MarkDecorator) -> list[tuple[str | None, tuple[object, ...]]]:
    return [(case.id, tuple(case.values)) for case in mark.args[1]]


def test_the_key_of_a_row_is_its_id() -> None:
    assert cases_of(table({"a flat battery": 0.4})) == [("a flat battery", (0.4,))]


def test_a_table_of_words_has_an_argument_for_each_column() -> None:
    found = text_table("""
        it is   | asked to
        # At rest.
        active  | stop

        stopped |
    """)

    assert found.args[0] == ["it_is", "asked_to"]
    assert cases_of(found) == [
        ("it is active, asked to stop", ("active", "stop")),
        ("it is stopped, asked to ", ("stopped", "")),
    ]


def test_a_row_has_as_many_cells_as_there_are_columns() -> None:
    with pytest.raises(ValueError, match="shorter"):
        text_table("it is | asked to\nactive")
