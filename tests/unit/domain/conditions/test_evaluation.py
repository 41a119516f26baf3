import math

import pytest

from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth, evaluate
from domain.conditions.facts import Observation
from tests.support.told_facts import ToldFacts

T, F, U = Truth.TRUE, Truth.FALSE, Truth.UNKNOWN
FACTS = ToldFacts(
    {
        "yes": True,
        "no": False,
        "level": 0.3,
        "count": 3,
        "word": "LOW",
        "broken": math.nan,
        "old": Observation(value=True, doubt="is stale"),
        "a.mode": None,
    }
)


def _truth(text: str) -> Truth:
    return evaluate(Condition(text), FACTS)


@pytest.mark.parametrize(
    ("left", "both", "either"),
    [
        ("yes and {}", (T, U, F), None),
        ("old and {}", (U, U, F), None),
        ("no and {}", (F, F, F), None),
        ("yes or {}", None, (T, T, T)),
        ("old or {}", None, (T, U, U)),
        ("no or {}", None, (T, U, F)),
    ],
)
def test_kleene_decides_as_soon_as_the_unknown_does_not_matter(
    left: str, both: tuple[Truth, ...] | None, either: tuple[Truth, ...] | None
) -> None:
    values = tuple(_truth(left.format(right)) for right in ("yes", "old", "no"))

    assert values == (both or either)


@pytest.mark.parametrize(
    ("text", "truth"),
    [
        ("not yes", F),
        ("not old", U),
        ("level >= 0.3", T),
        ("level > 0.3", F),
        ("level <= 0.3", T),
        ("level < 0.3", F),
        ("level == 0.3", T),
        ("level != 0.3", F),
        ("count == 3.0", T),
        ("count in [1, 3.0]", T),
        ("count not in [1, 2]", T),
        ("word == LOW", T),
        ("word in [HIGH, LOW]", T),
        ("word not in [HIGH]", T),
        ("yes == true", T),
        ("yes != true", F),
        ("yes in [false]", F),
        ("true", T),
        ("false", F),
    ],
)
def test_known_facts_compare_as_their_values_do(text: str, truth: Truth) -> None:
    assert _truth(text) is truth


@pytest.mark.parametrize(
    "text", ["old", "never == 1", "never != 1", "never in [1]", "never not in [1]", "broken < 1"]
)
def test_what_was_never_seen_or_is_stale_or_no_number_is_unknown(text: str) -> None:
    assert _truth(text) is U
    assert _truth(f"not {text}") is U


@pytest.mark.parametrize(
    "text", ["yes == 1", "count == true", "word < 3", "count > LOW", "yes > no"]
)
def test_what_cannot_be_compared_is_unknown(text: str) -> None:
    assert _truth(text) is U


@pytest.mark.parametrize(
    ("text", "truth"),
    [
        ("a.mode == SLOW", F),
        ("a.mode != SLOW", T),
        ("a.mode in [SLOW, FAST]", F),
        ("a.mode not in [SLOW, FAST]", T),
    ],
)
def test_a_part_without_a_mode_equals_no_mode(text: str, truth: Truth) -> None:
    assert _truth(text) is truth
