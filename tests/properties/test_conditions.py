"""Random conditions over random facts, beside an evaluator of the test's own.

That one knows nothing of trees, operators or Kleene's tables: it lets Python evaluate the text
itself, once for every way in which what is unknown might turn out. A condition is true if it is so
in each of them, false if it is so in none, and unknown otherwise; as long as each fact that is
unknown appears once only, that is Kleene's logic.
"""

import itertools
import random
import re
from collections.abc import Iterator, Mapping

import pytest

from domain.conditions.check import check
from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth, evaluate
from domain.conditions.explanation import explain
from domain.conditions.facts import Observation
from domain.conditions.tree import comparisons
from domain.conditions.vocabulary import Kind, Terms, Vocabulary
from domain.conditions.watched import WatchedConditions
from domain.findings import Blocker
from tests.support.told_facts import ToldFacts

ROUNDS = 2_000
WORDS = ("SLOW", "FAST", "IDLE")


def _facts(rng: random.Random, count: int) -> dict[str, Observation]:
    """Return facts by name: `n0` numbers, `b1` truths, `w2` words that may be none."""
    facts = {}
    for number in range(count):
        kind = rng.choice("nbw")
        value = {
            "n": rng.choice([0, 1, 2, 0.5]),
            "b": rng.random() < 0.5,
            "w": rng.choice([*WORDS, None]),
        }[kind]
        doubt = "is stale" if rng.random() < 0.25 else ""
        facts[f"{kind}{number}"] = Observation(value, doubt)
    return facts


def _leaf(rng: random.Random, name: str) -> str:
    if name[0] == "b":
        return rng.choice([name, f"{name} == true", f"{name} != true", f"{name} in [false]"])
    if name[0] == "n":
        if rng.random() < 0.2:
            return f"{name} {rng.choice(['in', 'not in'])} [0, {rng.choice([1, 0.5])}]"
        sign, limit = rng.choice(["<", "<=", ">", ">=", "==", "!="]), rng.choice([0, 0.5, 1])
        return rng.choice([f"{name} {sign} {limit}", f"{limit} {sign} {name}"])
    if rng.random() < 0.5:
        return f"{name} {rng.choice(['in', 'not in'])} [{', '.join(rng.sample(WORDS, 2))}]"
    return f"{name} {rng.choice(['==', '!='])} {rng.choice(WORDS)}"


def _text(rng: random.Random, names: list[str]) -> str:
    """Return a condition that names each of these facts once."""
    if len(names) == 1:
        text = rng.choice(["true", "false"]) if rng.random() < 0.05 else _leaf(rng, names[0])
    else:
        cut = rng.randint(1, len(names) - 1)
        parts = (_text(rng, names[:cut]), _text(rng, names[cut:]))
        text = f"({parts[0]}) {rng.choice(['and', 'or'])} ({parts[1]})"
    return f"not ({text})" if rng.random() < 0.25 else text


def _ways(text: str, facts: Mapping[str, Observation]) -> Iterator[str]:
    """Yield the text with each comparison of what is unknown replaced by true and by false."""
    parts = re.split(r"((?:[\d.]+ [<>=!]+ )?\b[nbw]\d+\b[^()]*?(?= and | or |\)|$))", text)
    unknown = [
        index
        for index, part in enumerate(parts)
        if (found := re.search(r"\b[nbw]\d+\b", part)) and facts[found[0]].doubt
    ]
    for values in itertools.product(("True", "False"), repeat=len(unknown)):
        for index, value in zip(unknown, values, strict=True):
            parts[index] = value
        yield "".join(parts)


def _by_python(text: str, facts: Mapping[str, Observation]) -> Truth:
    names = {name: fact.value for name, fact in facts.items()}
    names |= {"true": True, "false": False} | {word: word for word in WORDS}
    results = {bool(eval(way, {}, names)) for way in _ways(text, facts)}
    if len(results) > 1:
        return Truth.UNKNOWN
    return Truth.TRUE if results.pop() else Truth.FALSE


def _nodes(blocker: Blocker) -> Iterator[Blocker]:
    yield blocker
    for cause in blocker.causes:
        yield from _nodes(cause)


@pytest.mark.parametrize("seed", range(4))
def test_values_and_explanations_are_those_of_an_evaluator_of_our_own(seed: int) -> None:
    rng = random.Random(seed)
    seen = dict.fromkeys(Truth, 0)
    for _ in range(ROUNDS):
        facts = _facts(rng, rng.randint(1, 6))
        text = _text(rng, list(facts))
        condition, told = Condition(text), ToldFacts(facts)

        truth = _by_python(text, facts)
        explanation = explain(condition, told)

        assert evaluate(condition, told) is truth, (text, facts)
        seen[truth] += 1
        assert (explanation == ()) is (truth is Truth.TRUE), text
        for node in itertools.chain.from_iterable(map(_nodes, explanation)):
            assert node.condition is not None
            value = _by_python(node.condition, facts)
            assert value is not Truth.TRUE, (text, node.condition)
            assert (node.code == "UNKNOWN_VALUE") is (value is Truth.UNKNOWN), node
            assert node.root_cause is (not node.causes)
    assert min(seen.values()) > ROUNDS // 10


@pytest.mark.parametrize("seed", range(4))
def test_what_is_watched_has_the_value_that_it_has_anew(seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(60):
        facts = _facts(rng, 12)
        names = list(facts)
        told = ToldFacts(facts)
        texts = [_text(rng, rng.sample(names, rng.randint(1, 4))) for _ in range(20)]
        conditions = [Condition(text) for text in dict.fromkeys(texts)]
        watched = WatchedConditions(told)
        watched.watch(conditions, 0)
        before = {condition: watched.truth(condition) for condition in conditions}
        topics = {
            leaf.subject.text: leaf.subject.topic
            for condition in conditions
            for leaf in comparisons(condition.root)
        }
        for now in range(1, 10):
            for name in rng.sample(names, 3):
                fresh = _facts(rng, 40)
                other = next((fresh[each] for each in fresh if each[0] == name[0]), facts[name])
                told.observed[name] = other
                if name in topics:
                    watched.touch(topics[name])

            changed = watched.renew(now)

            for condition in conditions:
                truth = evaluate(condition, told)
                assert watched.truth(condition) is truth
                assert (condition in changed) is (truth is not before[condition])
                assert (watched.since(condition) == now) is (condition in changed)
                assert (watched.explain(condition) == ()) is (truth is Truth.TRUE)
                before[condition] = truth


# --- what the check says, and what then happens --------------------------------------------------

TERMS = {
    "n": Terms(Kind.NUMBER, 0.0, 2.0),
    "b": Terms(Kind.BOOLEAN),
    "w": Terms(Kind.WORD, words=WORDS),
}
VOCABULARY = Vocabulary({}, {f"{kind}{n}": TERMS[kind] for kind in "nbw" for n in range(3)}, ())


def _any_leaf(rng: random.Random) -> str:
    """Return a comparison that may make no sense."""
    name = f"{rng.choice('nbwx')}{rng.randint(0, 2)}"
    values = ["0", "0.5", "2", "7", "-1", "true", "false", "SLOW", "'FAST'", "OTHER"]
    how = rng.random()
    if how < 0.15:
        return name
    if how < 0.35:
        some = rng.sample(values, rng.randint(0, 3))
        return f"{name} {rng.choice(['in', 'not in'])} [{', '.join(some)}]"
    return f"{name} {rng.choice(['<', '<=', '>', '>=', '==', '!='])} {rng.choice(values)}"


@pytest.mark.parametrize("seed", range(4))
def test_what_passes_the_check_is_known_as_soon_as_the_facts_are(seed: int) -> None:
    rng = random.Random(seed)
    passed = dict.fromkeys(("error", "ALWAYS_TRUE", "NEVER_TRUE", ""), 0)
    for _ in range(ROUNDS):
        condition = Condition(_any_leaf(rng))
        faults = check(condition, VOCABULARY)
        codes = {fault.code for fault in faults}
        assert all(1 <= fault.column <= len(condition.text) for fault in faults)
        truths = set()
        for _ in range(12):
            values: dict[str, bool | float | str] = {
                "n": rng.choice([0.0, 0.5, 1, 2.0]),
                "b": rng.random() < 0.5,
                "w": rng.choice(WORDS),
            }
            told = ToldFacts({name: values[name[0]] for name in VOCABULARY.signals})
            truths.add(evaluate(condition, told))
        if any(fault.severity == "error" for fault in faults):
            passed["error"] += 1
            continue
        assert Truth.UNKNOWN not in truths, condition.text
        (leaf,) = comparisons(condition.root)
        if len(leaf.values) == 1 and codes:
            (code,) = codes
            assert truths == {Truth.TRUE if code == "ALWAYS_TRUE" else Truth.FALSE}, condition.text
            passed[code] += 1
        passed[""] += not codes
    assert min(passed.values()) > ROUNDS // 100, passed
