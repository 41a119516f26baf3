"""What keeps a part from a mode, by values that a test sets."""

from collections.abc import Sequence

import pytest

from domain.changes.guards import Guards
from domain.conditions.condition import Condition
from domain.conditions.watched import WatchedConditions
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName
from domain.timebase import seconds
from tests.support.guards import SetFacts
from tests.support.models import ACTUATION, ARM, BASE, FAST, PERFORMANCE, SLOW, active, inactive
from tests.support.models import actuation_model as plain_model

CHARGED, COOL = Condition("battery_level >= 0.3"), Condition("temperature < 50")
TARGETS = {ACTUATION: active(PERFORMANCE), BASE: active(FAST)}


class Guarded:
    """Guards of two modes, and the signals that they name."""

    def __init__(self, grace_s: float = 0.0) -> None:
        grace = seconds(grace_s)
        model = plain_model()
        self.model = SmhModel(
            model.nodes,
            model.systems,
            {
                ACTUATION: {PERFORMANCE: ModeSettings((CHARGED,), (COOL,), grace)},
                BASE: {FAST: ModeSettings((), (COOL,), grace)},
            },
        )
        self.facts = SetFacts({"battery_level": 0.9, "temperature": 20.0})
        self.watched = WatchedConditions(self.facts)
        self.guards = Guards(self.model, self.watched, 0)

    def set(self, now: int, **values: float) -> None:
        """Let signals have other values."""
        self.facts.values |= values
        for topic in self.watched.topics:
            self.watched.touch(topic)
        self.watched.renew(now)

    def codes(self, parts: Sequence[PartName] = (ACTUATION, BASE)) -> list[tuple[str, str]]:
        """Return code and first part of each blocker."""
        return [(b.code, b.path[0]) for b in self.guards.blockers(parts, TARGETS)]


def test_only_parts_with_a_guard_that_does_not_hold_have_to_be_looked_at() -> None:
    robot = Guarded()
    assert robot.guards.failing({ACTUATION, BASE, ARM}) == []
    robot.set(5, battery_level=0.2)
    assert robot.guards.failing({ACTUATION, BASE, ARM}) == [ACTUATION]
    robot.set(6, temperature=60.0)
    assert robot.guards.failing({ACTUATION, BASE, ARM}) == [ACTUATION, BASE]
    assert robot.guards.failing({BASE}) == [BASE]
    robot.set(7, temperature=20.0)
    assert robot.guards.failing({ACTUATION, BASE, ARM}) == [ACTUATION]


def test_only_guards_of_the_target_mode_count() -> None:
    robot = Guarded()
    robot.set(5, temperature=60.0)
    assert len(list(robot.guards.blockers((BASE,), {BASE: active(FAST)}))) == 1
    assert not list(robot.guards.blockers((BASE,), {BASE: active(SLOW)}))
    assert not list(robot.guards.blockers((BASE,), {BASE: inactive()}))


def test_whoever_asks_learns_once_which_parts_have_a_guard_that_changed() -> None:
    robot = Guarded()
    assert robot.guards.take_moved() == set()
    robot.set(5, battery_level=0.2)
    assert robot.guards.take_moved() == {ACTUATION}
    assert robot.guards.take_moved() == set()
    robot.set(6, battery_level=0.9, temperature=60.0)
    assert robot.guards.take_moved() == {ACTUATION, BASE}


def test_a_mode_can_be_entered_while_all_its_guards_are_true() -> None:
    assert Guarded().codes() == []


def test_a_requirement_that_is_not_true_blocks_with_its_value_and_threshold() -> None:
    robot = Guarded()
    robot.set(5, battery_level=0.2)
    (blocker,) = robot.guards.blockers((ACTUATION,), TARGETS)
    assert (blocker.code, blocker.path) == ("CONDITION", ("actuation", "battery_level"))
    assert (blocker.value, blocker.threshold, blocker.refuses) == (0.2, 0.3, True)
    assert blocker.condition == CHARGED.text


def test_a_broken_invariant_blocks_every_part_that_has_it() -> None:
    robot = Guarded()
    robot.set(5, temperature=60.0)
    assert robot.codes() == [("INVARIANT", "actuation"), ("INVARIANT", "drive_base")]
    (blocker,) = robot.guards.blockers((BASE,), TARGETS)
    assert blocker.message == "drive_base cannot stay FAST: temperature is 60, needs < 50"
    assert [cause.code for cause in blocker.causes] == ["CONDITION"]


def test_a_guard_over_what_is_not_known_does_not_hold() -> None:
    robot = Guarded()
    del robot.facts.values["battery_level"]
    robot.set(5)
    assert robot.codes((ACTUATION,)) == [("UNKNOWN_VALUE", "actuation")]


def test_a_mode_can_be_stayed_in_while_its_invariants_hold_whatever_it_requires() -> None:
    robot = Guarded()
    robot.set(5, battery_level=0.1)
    assert robot.guards.can_stay(ACTUATION, PERFORMANCE)
    robot.set(6, temperature=60.0)
    assert not robot.guards.can_stay(ACTUATION, PERFORMANCE)


@pytest.mark.parametrize(("grace_s", "codes"), [(0.0, ["INVARIANT"]), (1.0, [])])
def test_a_step_may_begin_during_the_grace_of_an_invariant(
    grace_s: float, codes: list[str]
) -> None:
    robot = Guarded(grace_s)
    robot.set(5, temperature=60.0)
    found = robot.guards.blockers_of_step((BASE,), TARGETS)
    assert [blocker.code for blocker in found] == codes


def test_an_invariant_counts_as_broken_once_its_grace_is_over() -> None:
    robot = Guarded(grace_s=2)
    robot.set(seconds(5), temperature=60.0)
    broken, due = robot.guards.broken_for_too_long((BASE,), TARGETS, seconds(6))
    assert (broken, due) == (None, seconds(7))
    broken, _ = robot.guards.broken_for_too_long((BASE,), TARGETS, seconds(7))
    assert broken is not None


def test_an_unknown_invariant_may_be_given_time_to_become_known() -> None:
    robot = Guarded()
    del robot.facts.values["temperature"]
    robot.set(seconds(5))
    judge = robot.guards.broken_for_too_long
    broken, due = judge((BASE,), TARGETS, seconds(6), unknown_from=seconds(7))
    assert (broken, due) == (None, seconds(7))
    broken, _ = judge((BASE,), TARGETS, seconds(7), unknown_from=seconds(7))
    assert broken is not None


def test_an_invariant_that_recovered_in_between_begins_its_grace_anew() -> None:
    robot = Guarded(grace_s=2)
    robot.set(seconds(5), temperature=60.0)
    robot.set(seconds(6), temperature=20.0)
    robot.set(seconds(6.5), temperature=60.0)
    _, due = robot.guards.broken_for_too_long((BASE,), TARGETS, seconds(7))
    assert due == seconds(8.5)
