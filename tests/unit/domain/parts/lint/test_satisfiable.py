from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth, compare, truth_of
from domain.conditions.facts import Observation
from domain.conditions.tree import Comparison, Node, Subject, Value, negated
from domain.parts.lint.budget import Budget
from domain.parts.lint.satisfiable import Satisfiability, equals
from domain.parts.lint.values import Values

SEARCH = Satisfiability(Budget(10**9)).can_be_true
VALUES: dict[str, tuple[Value, ...]] = {
    "x": (0, 1, 2), "y": (0, 1, 2), "word": ("A", "B", "C"), "flag": (True, False),
}  # fmt: skip
LEAVES = st.sampled_from(
    [f"{name} {sign} {value}" for name in "xy" for sign in ("<", "<=", ">", ">=", "==", "!=")
     for value in (0, 1, 2)]
    + ["word == A", "word != B", "word in [A, C]", "word not in [A, B]", "flag", "not flag",
       "true", "false"]
)  # fmt: skip
TEXTS = st.recursive(
    LEAVES,
    lambda inner: (
        st.builds("({} {} {})".format, inner, st.sampled_from(["and", "or"]), inner)
        | st.builds("not {}".format, inner.map("({})".format))
    ),
    max_leaves=8,
)


def values_of(subject: Subject) -> Values:
    return Values.of(VALUES[subject.topic.name])


def possible(*texts: str) -> bool:
    return SEARCH([Condition.parse(text).root for text in texts], values_of)


def is_true_for_some_values(*texts: str) -> bool:
    """Try all values, with the evaluator of the robot."""
    roots = [Condition.parse(text).root for text in texts]
    return any(
        all(_is_true(root, dict(zip(VALUES, values, strict=True))) for root in roots)
        for values in product(*VALUES.values())
    )


def _is_true(root: Node, facts: dict[str, Value]) -> bool:
    def truth(leaf: Comparison) -> Truth:
        return compare(leaf, Observation(facts[leaf.subject.topic.name]))

    return truth_of(root, truth) is Truth.TRUE


@given(TEXTS, TEXTS)
def test_conditions_are_possible_exactly_if_some_values_make_them_true(
    one: str, other: str
) -> None:
    assert possible(one, other) == is_true_for_some_values(one, other)


@given(TEXTS)
def test_a_condition_and_its_negation_are_never_true_together(text: str) -> None:
    root = Condition.parse(text).root

    assert not SEARCH([root, negated(root)], values_of)


def test_what_follows_from_a_comparison_counts() -> None:
    x, y = Condition.parse("x == 1").root, Condition.parse("y == 2").root
    word = Subject(equals(_subject("y"), 0).subject.topic)

    assert SEARCH([x, y], values_of)
    assert not SEARCH([x, y], values_of, lambda leaf: [equals(word, 0)])


def test_a_search_that_would_take_too_long_counts_as_possible() -> None:
    # Whatever is chosen for the first 25 pairs, the last two contradict each other.
    choices = [f"a{number} == 1 or b{number} == 1" for number in range(25)]
    never = ["z == 1 or z == 2", "z == 3 or z == 4"]

    def search(texts: list[str]) -> bool:
        roots = [Condition.parse(text).root for text in texts]
        return SEARCH(roots, lambda _subject: Values())

    assert not search(never)
    assert search([*choices[:13], *never, *choices[13:]])


def test_without_a_budget_everything_counts_as_possible() -> None:
    budget = Budget(3)
    never = [Condition.parse("x == 0 and x == 1").root]
    search = Satisfiability(budget).can_be_true

    assert not search(never, values_of)
    assert search(never, values_of)
    assert budget.is_spent


def _subject(name: str) -> Subject:
    leaf = Condition.parse(f"{name} == 1").root
    return leaf.subject  # type: ignore[union-attr]
