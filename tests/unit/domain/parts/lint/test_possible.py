import pytest

from domain.conditions.condition import Condition
from domain.conditions.tree import Comparison
from domain.health.signals import default_signals
from domain.parts.lint.possible import PossibleValues
from domain.robot_vocabulary import vocabulary_of
from domain.state_and_mode import PartName, StateAndMode
from tests.support.lint_models import model_of, node, system

MODEL = model_of(
    system("s", default={"n": "active"}, FAST={"n": "active.FAST"}),
    node(default={"a": 1, "list": (1, 2), "nan": float("nan")}, FAST={"a": 2}),
)
POSSIBLE = PossibleValues(MODEL, vocabulary_of(MODEL, default_signals(), is_complete=True))


def leaf(text: str) -> Comparison:
    root = Condition.parse(text).root
    assert isinstance(root, Comparison)
    return root


def can_be(text: str) -> bool:
    own = leaf(text)
    return not POSSIBLE.of(own.subject).after(own).is_empty


@pytest.mark.parametrize(
    "text",
    ["n.state == active", "n.mode == FAST", "n.reachable", "battery_level == 1", "estop",
     "n.parameters.a == 7", "robot.state == IDLE", "unheard_of == 3", "vehicle.speed_mps == -3"],
)  # fmt: skip
def test_a_fact_can_be_what_its_kind_allows(text: str) -> None:
    assert can_be(text)


@pytest.mark.parametrize(
    "text",
    ["n.state == FAST", "n.mode == SLOW", "n.reachable == 3", "battery_level == 1.1",
     "robot.state == BROKEN", "signal_strength == GOOD"],
)  # fmt: skip
def test_a_fact_cannot_be_anything_else(text: str) -> None:
    assert not can_be(text)


def test_a_node_in_a_mode_is_active_and_can_be_reached() -> None:
    assert [own.text for own in POSSIBLE.follows(leaf("n.mode == FAST"))] == [
        "n.state in [active, activating]",
        "n.reachable in [true]",
    ]


def test_a_system_is_in_a_state_whoever_can_be_reached() -> None:
    assert list(POSSIBLE.follows(leaf("s.state == active"))) == []


@pytest.mark.parametrize("text", ["battery_level > 0.3", "n.reachable", "robot.state == IDLE"])
def test_nothing_follows_from_other_facts(text: str) -> None:
    assert list(POSSIBLE.follows(leaf(text))) == []


def test_a_node_in_a_mode_has_its_parameters_as_far_as_they_can_be_compared() -> None:
    facts = POSSIBLE.facts_of(PartName("n"), StateAndMode.parse("active.FAST"))

    assert [fact.text for fact in facts] == [
        "n.state in [active]",
        "n.mode in [FAST]",
        "n.parameters.a in [2]",
    ]


def test_a_part_at_rest_is_inactive_or_unconfigured() -> None:
    facts = POSSIBLE.facts_of(PartName("s"), StateAndMode.parse("inactive"))

    assert [fact.text for fact in facts] == ["s.state in [inactive, unconfigured]"]
