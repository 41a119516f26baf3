from domain.changes.guarded_changes import GuardedChanges
from domain.changes.guards import Guards
from domain.changes.record import Change
from domain.conditions.condition import Condition
from domain.conditions.tree import Topic, TopicKind
from domain.conditions.watched import WatchedConditions
from domain.identifiers import ChangeId
from domain.inputs import ModeRequest
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import SmhModel
from domain.timebase import seconds
from tests.support.guards import SetFacts
from tests.support.models import ACTUATION, ARM, BASE, PERFORMANCE, active, actuation_model

COOL = Condition("temperature < 50")
MODEL = actuation_model()


class Guarded:
    """One running change whose mode has an invariant."""

    def __init__(self, grace_s: float = 0.0) -> None:
        settings = ModeSettings((), (COOL,), seconds(grace_s))
        model = SmhModel(MODEL.nodes, MODEL.systems, {ACTUATION: {PERFORMANCE: settings}})
        self.facts = SetFacts({"temperature": 20.0})
        self.watched = WatchedConditions(self.facts)
        self.changes = GuardedChanges(Guards(model, self.watched, 0), model)
        targets = {ACTUATION: active(PERFORMANCE)}
        request = ModeRequest(ACTUATION, PERFORMANCE)
        self.change = Change(ChangeId("c1"), ACTUATION, request, targets, 0, 1)
        self.changes.add(self.change)

    def heat(self, now: int, value: float = 60.0) -> None:
        """Let the temperature change."""
        self.facts.values["temperature"] = value
        self.watched.touch(Topic(TopicKind.SIGNAL, "temperature"))
        self.watched.renew(now)


def test_a_change_goes_on_while_its_invariants_hold() -> None:
    robot = Guarded()
    assert robot.changes.broken(0) == []
    assert robot.changes.forbids(robot.change, BASE) is None


def test_a_change_is_broken_as_soon_as_an_invariant_is() -> None:
    robot = Guarded()
    robot.changes.broken(0)
    robot.heat(5)
    ((change, why),) = robot.changes.broken(5)
    assert change is robot.change
    assert why == "actuation cannot stay PERFORMANCE: temperature is 60, needs < 50"


def test_the_end_of_the_grace_is_known_ahead() -> None:
    robot = Guarded(grace_s=2)
    robot.heat(seconds(1))
    assert robot.changes.broken(seconds(1)) == []
    assert robot.changes.due == seconds(3)
    assert len(robot.changes.broken(seconds(3))) == 1


def test_guards_of_a_part_can_be_left_out() -> None:
    robot = Guarded()
    robot.changes.add(robot.change, unguarded=(ACTUATION,))
    robot.heat(5)
    assert robot.changes.broken(5) == []
    assert robot.changes.forbids(robot.change, BASE) is None


def test_a_change_that_was_dropped_is_judged_no_more() -> None:
    robot = Guarded(grace_s=2)
    robot.heat(seconds(1))
    robot.changes.broken(seconds(1))
    robot.changes.drop(robot.change)
    assert robot.changes.due is None
    assert robot.changes.broken(seconds(9)) == []


def test_a_node_is_kept_from_its_step_by_the_guards_of_the_systems_above_it() -> None:
    robot = Guarded()
    robot.heat(5)
    assert robot.changes.forbids(robot.change, ARM) is not None
