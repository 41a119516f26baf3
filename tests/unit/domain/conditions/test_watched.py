from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth
from domain.conditions.facts import Observation
from domain.conditions.tree import Subject, Topic, TopicKind
from domain.conditions.watched import WatchedConditions
from domain.timebase import seconds
from tests.support.told_facts import ToldFacts

BATTERY = Topic(TopicKind.SIGNAL, "battery_level")
BASE = Topic(TopicKind.PART, "drive_base")


class CountedFacts(ToldFacts):
    """Counts what is looked at."""

    looks = 0

    def observe(self, subject: Subject) -> Observation:
        """Return what was told, and count."""
        self.looks += 1
        return super().observe(subject)


def _texts(conditions: tuple[Condition, ...]) -> list[str]:
    return [condition.text for condition in conditions]


def test_a_reading_renews_the_conditions_that_name_it_and_tells_which_changed() -> None:
    facts = ToldFacts({"battery_level": 0.5, "drive_base.state": "active"})
    low, both = Condition("battery_level < 0.3"), Condition("battery_level >= 0.3 and estop")
    other = Condition("drive_base.state == active")
    watched = WatchedConditions(facts)
    watched.watch([low, both, other], 0)
    assert (watched.truth(low), watched.truth(both)) == (Truth.FALSE, Truth.UNKNOWN)

    facts.observed["battery_level"] = 0.2
    watched.touch(BATTERY)

    assert _texts(watched.renew(seconds(3))) == [low.text, both.text]
    assert (watched.truth(low), watched.truth(both)) == (Truth.TRUE, Truth.FALSE)
    assert (watched.since(low), watched.since(other)) == (seconds(3), 0)


def test_whoever_follows_learns_what_changed_since_they_looked() -> None:
    facts = ToldFacts({"battery_level": 0.5})
    low, high = Condition("battery_level < 0.3"), Condition("battery_level > 0.9")
    watched = WatchedConditions(facts)
    watched.watch([high], 0)
    changed = watched.follow([low], 0)
    assert changed == {low.text: low}
    changed.clear()

    facts.observed["battery_level"] = 0.95
    watched.touch(BATTERY)
    watched.renew(1)
    assert changed == {}

    facts.observed["battery_level"] = 0.2
    watched.touch(BATTERY)
    watched.renew(2)
    assert changed == {low.text: low}


def test_parts_of_which_an_attribute_is_named_are_known() -> None:
    watched = WatchedConditions(ToldFacts({}))
    watched.watch([Condition("drive_base.converged or lidar.state == active")], 0)
    assert watched.parts_named_by("converged") == {"drive_base"}


def test_nothing_changes_before_something_is_touched() -> None:
    facts = ToldFacts({"battery_level": 0.5})
    low = Condition("battery_level < 0.3")
    watched = WatchedConditions(facts)
    watched.watch([low], 0)

    facts.observed["battery_level"] = 0.2
    watched.touch(BASE)

    assert watched.renew(1) == ()
    assert watched.truth(low) is Truth.FALSE


def test_a_value_that_decides_nothing_changes_no_condition() -> None:
    facts = ToldFacts({"battery_level": 0.5})
    condition = Condition("battery_level >= 0.3 or estop")
    watched = WatchedConditions(facts)
    watched.watch([condition], 0)

    facts.observed["battery_level"] = 0.4
    watched.touch(BATTERY)

    assert watched.renew(seconds(1)) == ()
    assert watched.since(condition) == 0


def test_a_leaf_tells_since_when_it_is_not_true() -> None:
    facts = ToldFacts({"battery_level": 0.5, "temperature": 60.0})
    condition = Condition("battery_level >= 0.3 and temperature < 50")
    watched = WatchedConditions(facts)
    watched.watch([condition], seconds(1))

    facts.observed["battery_level"] = 0.2
    watched.touch(BATTERY)
    watched.renew(seconds(4))
    facts.observed["battery_level"] = 0.1
    watched.touch(BATTERY)
    watched.renew(seconds(5))

    (blocker,) = watched.explain(condition)
    assert blocker.since == seconds(1)
    assert [(cause.value, cause.since) for cause in blocker.causes] == [
        (0.1, seconds(4)),
        (60.0, seconds(1)),
    ]


def test_a_true_condition_is_explained_by_nothing() -> None:
    condition = Condition("battery_level >= 0.3")
    watched = WatchedConditions(ToldFacts({"battery_level": 0.5}))
    watched.watch([condition], 0)

    assert watched.explain(condition) == ()


def test_conditions_that_are_watched_twice_are_one() -> None:
    facts = CountedFacts({"battery_level": 0.5})
    watched = WatchedConditions(facts)
    watched.watch([Condition("battery_level < 0.3")], 0)

    watched.watch([Condition("battery_level < 0.3")], seconds(9))

    assert watched.since(Condition("battery_level < 0.3")) == 0
    assert facts.looks == 1


def test_what_does_not_name_a_topic_costs_nothing_however_many_there_are() -> None:
    looks = []
    for others in (100, 10_000):
        facts = CountedFacts({"battery_level": 0.5})
        watched = WatchedConditions(facts)
        watched.watch([Condition(f"s{i} < {i}") for i in range(others)], 0)
        watched.watch([Condition(f"battery_level < 0.{i}") for i in range(1, 9)], 0)
        facts.looks = 0
        facts.observed["battery_level"] = 0.35
        watched.touch(BATTERY)

        changed = watched.renew(1)

        looks.append((facts.looks, len(changed)))
    assert looks == [(1, 2), (1, 2)]


def test_changes_come_in_the_order_of_what_was_touched() -> None:
    facts = ToldFacts({"a": False, "b": False})
    watched = WatchedConditions(facts)
    watched.watch([Condition("a"), Condition("b"), Condition("a or b")], 0)
    facts.observed = {"a": True, "b": True}

    watched.touch(Topic(TopicKind.SIGNAL, "b"))
    watched.touch(Topic(TopicKind.SIGNAL, "a"))

    assert _texts(watched.renew(1)) == ["b", "a or b", "a"]


def _look(watched: WatchedConditions, facts: ToldFacts, *levels: float | None) -> None:
    """Let the battery have these levels, one after the other in one look at 3 s."""
    for number, level in enumerate(levels):
        facts.observed["battery_level"] = level
        watched.touch(BATTERY)
        watched.renew(seconds(3), goes_on=number > 0)


def test_a_value_that_ends_in_the_same_look_leaves_no_trace() -> None:
    facts = ToldFacts({"battery_level": 0.5})
    high = Condition("battery_level > 0.3")
    watched = WatchedConditions(facts)
    watched.watch([high], 0)

    _look(watched, facts, 0.2, 0.5)
    assert (watched.truth(high), watched.since(high)) == (Truth.TRUE, 0)
    assert watched.broken_since(high) is None

    _look(watched, facts, 0.2)
    _look(watched, facts, 0.5)
    assert watched.since(high) == seconds(3)


def test_what_is_false_and_unknown_only_within_a_look_stays_false_since_then() -> None:
    facts = ToldFacts({"battery_level": 0.2})
    high = Condition("battery_level > 0.3")
    watched = WatchedConditions(facts)
    watched.watch([high], 0)

    _look(watched, facts, None, 0.5, 0.2)
    assert (watched.since(high), watched.broken_since(high)) == (0, 0)


def test_what_goes_on_at_a_later_time_has_lasted() -> None:
    facts = ToldFacts({"battery_level": 0.5})
    high = Condition("battery_level > 0.3")
    watched = WatchedConditions(facts)
    watched.watch([high], 0)

    _look(watched, facts, 0.2)
    facts.observed["battery_level"] = 0.5
    watched.touch(BATTERY)
    watched.renew(seconds(4), goes_on=True)
    assert (watched.since(high), watched.broken_since(high)) == (seconds(4), None)
