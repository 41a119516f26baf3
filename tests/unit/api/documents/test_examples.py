"""The examples that come with the package."""

from api.documents.examples import key_of, load_examples


def test_they_are_there() -> None:
    examples = load_examples()

    assert examples.requests
    assert examples.stream


def test_no_two_examples_of_an_operation_are_called_the_same() -> None:
    named = [(item.operation, key_of(item.summary)) for item in load_examples().requests]

    assert len(set(named)) == len(named)


def test_a_summary_becomes_a_name() -> None:
    assert key_of("As CSV, instead of the first") == "as_csv_instead_of_the_first"
