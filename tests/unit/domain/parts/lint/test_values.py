import pytest

from domain.conditions.condition import Condition
from domain.conditions.tree import Comparison
from domain.parts.lint.values import Values


def after(*texts: str, values: Values | None = None) -> Values:
    """Return the values of `x` that are left after comparisons."""
    left = Values() if values is None else values
    for text in texts:
        leaf = Condition.parse(text).root
        assert isinstance(leaf, Comparison)
        left = left.after(leaf)
    return left


@pytest.mark.parametrize(
    "texts",
    [
        ("x > 1", "x < 1"),
        ("x >= 1", "x < 1"),
        ("x > 1", "x <= 1"),
        ("x >= 2", "x <= 1"),
        ("x >= 1", "x <= 1", "x != 1"),
        ("x == 1", "x == 2"),
        ("x == 1", "x > 1"),
        ("x in [1, 2]", "x > 2"),
        ("x in [1, 2]", "x not in [1, 2, 3]"),
        ("x == A", "x == B"),
        ("x == true", "x == false"),
        ("x == 1", "x == true"),
    ],
)
def test_comparisons_that_leave_nothing_leave_nothing(texts: tuple[str, ...]) -> None:
    assert after(*texts).is_empty
    assert after(*reversed(texts)).is_empty


@pytest.mark.parametrize(
    "texts",
    [
        (),
        ("x > 1", "x < 2"),
        ("x >= 1", "x <= 1"),
        ("x > 1", "x != 2"),
        ("x == 1", "x == 1.0"),
        ("x in [1, 2]", "x > 1"),
        ("x != A", "x != B"),
        ("x > 0", "x > 1", "x > 0.5", "x < 1.5"),
    ],
)
def test_comparisons_that_leave_something_leave_something(texts: tuple[str, ...]) -> None:
    assert not after(*texts).is_empty
    assert not after(*reversed(texts)).is_empty


def test_of_listed_values_each_can_be_taken_away() -> None:
    words = Values.of(("A", "B", None))

    assert not after("x != A", "x != B", values=words).is_empty, "no value is left, such as no mode"
    assert words.without(("A", "B")).after(Condition.parse("x in [A, B]").root).is_empty  # type: ignore[arg-type]


def test_an_order_of_words_takes_nothing_away() -> None:
    assert not after("x > A", values=Values.of(("A",))).is_empty
