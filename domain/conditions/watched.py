"""Conditions that are kept up to date: a change touches only those that name what changed."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field, replace
from itertools import chain

from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth, compare, truth_of
from domain.conditions.explanation import explain, explain_true
from domain.conditions.facts import Facts
from domain.conditions.tree import Comparison, Subject, Topic, TopicKind, Value, comparisons
from domain.findings import Blocker
from domain.timebase import Instant


@dataclass(slots=True)
class _Watched:
    """A condition with its value."""

    condition: Condition
    truth: Truth
    since: Instant
    broken_since: Instant | None
    """Since when it is false or unknown; None: it is true."""
    followers: list[dict[str, Condition]] = field(default_factory=list)
    """Where it is noted that its value changed."""
    look: int = 0
    """Number of the look in which it got its value."""
    before: tuple[Truth, Instant, Instant | None] | None = None
    """Value, `since` and `broken_since` before that look; None: it had none."""

    def turn(self, truth: Truth, now: Instant, look: int) -> None:
        """Take another value; one that ends in the same look leaves no trace.

        Of two errors that are decided about in one step, the first may end what the second begins.
        """
        if self.look != look:
            self.look, self.before = look, (self.truth, self.since, self.broken_since)
        elif self.since == now and self.before is not None and self.before[0] is truth:
            self.truth, self.since, self.broken_since = self.before
            return
        self.truth, self.since = truth, now
        if truth is Truth.TRUE:
            self.broken_since = None
        elif self.broken_since is None:
            self.broken_since = now


@dataclass(slots=True)
class _Leaf:
    """A comparison with its value, shared by all conditions that have it."""

    comparison: Comparison
    truth: Truth
    since: Instant
    conditions: list[_Watched] = field(default_factory=list)


class WatchedConditions:
    """Conditions with their values, and since when they have them.

    Whoever changes a fact touches its topic; `renew` evaluates what names it. A comparison that
    several conditions have is evaluated once, and a condition only if one of its comparisons
    changed. Nothing is explained before it is asked for.
    """

    def __init__(self, facts: Facts) -> None:
        self._facts = facts
        self._watched: dict[str, _Watched] = {}
        """By text, in the order in which they were added."""
        self._leaves: dict[str, _Leaf] = {}
        self._by_topic: dict[Topic, dict[Subject, list[_Leaf]]] = {}
        self._touched: dict[Topic, None] = {}
        """In the order in which they were touched."""
        self._look = 0
        self.may_have_changed = False
        """Whether facts may have changed since the last `renew`."""
        self.revision = 0
        """Rises whenever a condition gets another value."""
        self.leaf_revision = 0
        """Rises whenever a comparison does, and so the reason of a condition may be another one."""

    @property
    def topics(self) -> Collection[Topic]:
        """Return what the conditions name."""
        return self._by_topic.keys()

    def parts_named_by(self, attribute: str) -> frozenset[str]:
        """Return the parts of which a condition names this attribute."""
        subjects = chain.from_iterable(self._by_topic.values())
        return frozenset(
            subject.topic.name
            for subject in subjects
            if subject.topic.kind is TopicKind.PART and subject.attribute == attribute
        )

    def watch(self, conditions: Iterable[Condition], now: Instant) -> None:
        """Add conditions, and evaluate them; those that are watched already stay as they are.

        Args:
            conditions: In an order that is the same in each run.
            now: The current time; from here on, `since` counts.
        """
        for condition in conditions:
            if condition.text in self._watched:
                continue
            leaves = {leaf.text: self._leaf(leaf, now) for leaf in comparisons(condition.root)}
            truth = self._truth_of(condition)
            broken_since = None if truth is Truth.TRUE else now
            watched = _Watched(condition, truth, now, broken_since)
            self._watched[condition.text] = watched
            for leaf in leaves.values():
                leaf.conditions.append(watched)

    def follow(self, conditions: Iterable[Condition], now: Instant) -> dict[str, Condition]:
        """Add conditions; return where those whose value changed are noted by their text.

        Whoever follows them removes them from there. At first, all of them are in it.
        """
        noted: dict[str, Condition] = {}
        for condition in conditions:
            if condition.text not in noted:
                self.watch((condition,), now)
                noted[condition.text] = condition
                self._watched[condition.text].followers.append(noted)
        return noted

    def touch(self, topic: Topic) -> None:
        """Note that something about a topic changed."""
        if topic in self._by_topic:
            self._touched[topic] = None

    def renew(self, now: Instant, *, goes_on: bool = False) -> tuple[Condition, ...]:
        """Evaluate what was touched; return the conditions whose value changed.

        They come in the order in which they were touched, and then in which they were added.

        Args:
            now: The current time.
            goes_on: What was touched follows from the last look, and belongs to it.
        """
        if not goes_on:
            self._look += 1
        self.may_have_changed = False
        doubtful: dict[str, _Watched] = {}
        touched, self._touched = self._touched, {}
        for topic in touched:
            for subject, leaves in self._by_topic[topic].items():
                observed = self._facts.observe(subject)
                for leaf in leaves:
                    truth = compare(leaf.comparison, observed)
                    if truth is not leaf.truth:
                        leaf.truth, leaf.since = truth, now
                        self.leaf_revision += 1
                        doubtful.update((each.condition.text, each) for each in leaf.conditions)
        changed = []
        for watched in doubtful.values():
            truth = self._truth_of(watched.condition)
            if truth is not watched.truth:
                watched.turn(truth, now, self._look)
                changed.append(watched.condition)
                for noted in watched.followers:
                    noted[watched.condition.text] = watched.condition
        self.revision += len(changed)
        return tuple(changed)

    def truth(self, condition: Condition) -> Truth:
        """Return the value of a condition that is watched, as of the last `renew`."""
        return self._watched[condition.text].truth

    def since(self, condition: Condition) -> Instant:
        """Return since when a condition that is watched has its value."""
        return self._watched[condition.text].since

    def broken_since(self, condition: Condition) -> Instant | None:
        """Return since when a condition that is watched is false or unknown; None: it is true."""
        return self._watched[condition.text].broken_since

    def value_of(self, subject: Subject) -> Value | None:
        """Return the value of a fact; None: there is none, or it is not known."""
        observed = self._facts.observe(subject)
        return None if observed.doubt else observed.value

    def explain(self, condition: Condition) -> tuple[Blocker, ...]:
        """Return why a condition that is watched is not true; empty: it is."""
        since = self._watched[condition.text].broken_since
        found = explain(condition, self._facts, self._since_of_leaf)
        return tuple(replace(b, since=since) if b.since is None else b for b in found)

    def explain_true(self, condition: Condition) -> tuple[Blocker, ...]:
        """Return why a condition that is watched is not false; empty: it is."""
        since = self._watched[condition.text].since
        found = explain_true(condition, self._facts, self._since_of_leaf)
        return tuple(replace(b, since=since) if b.since is None else b for b in found)

    # --- inside ----------------------------------------------------------------------------------

    def _leaf(self, comparison: Comparison, now: Instant) -> _Leaf:
        leaf = self._leaves.get(comparison.text)
        if leaf is None:
            subject = comparison.subject
            truth = compare(comparison, self._facts.observe(subject))
            leaf = self._leaves[comparison.text] = _Leaf(comparison, truth, now)
            by_subject = self._by_topic.setdefault(subject.topic, {})
            by_subject.setdefault(subject, []).append(leaf)
        return leaf

    def _truth_of(self, condition: Condition) -> Truth:
        return truth_of(condition.root, lambda leaf: self._leaves[leaf.text].truth)

    def _since_of_leaf(self, leaf: Comparison) -> Instant | None:
        """Return since when a comparison has its value; of one that is turned round, None."""
        watched = self._leaves.get(leaf.text)
        return None if watched is None else watched.since
