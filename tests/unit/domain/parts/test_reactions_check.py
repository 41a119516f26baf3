from dataclasses import replace

import pytest

from domain.conditions.condition import Condition
from domain.lifecycle import LifecycleState
from domain.parts.declared_errors import DeclaredError
from domain.parts.declared_reactions import DeclaredReaction, Escalation
from domain.parts.reactions_check import check_reactions
from domain.reaction_terms import Action, Until
from domain.snapshot import ErrorKey
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.timebase import seconds

CARRIER, DRIVE = PartName("carrier"), PartName("drive")
MODES = {CARRIER: [ModeName("__DEFAULT__"), ModeName("SLOW")], DRIVE: list[ModeName]()}
SLOW = StateAndMode(LifecycleState.ACTIVE, ModeName("SLOW"))
REST = StateAndMode(LifecycleState.INACTIVE)

TARGETS = {Action.MODE: SLOW, Action.STATE: REST}


def reaction(
    when: str, action: Action, name: str = "R", part: PartName = CARRIER
) -> DeclaredReaction:
    return DeclaredReaction(name, part, Condition(when), action, target=TARGETS.get(action))


def codes(
    *reactions: DeclaredReaction,
    errors: dict[PartName, dict[str, DeclaredError]] | None = None,
) -> list[str]:
    return [f.code for f in check_reactions(reactions, MODES, {DRIVE}, errors or {})]


@pytest.mark.parametrize("action", [Action.MODE, Action.STATE])
@pytest.mark.parametrize(
    "when",
    [
        "carrier.mode == SLOW",
        "carrier.state != active",
        "battery_level < 0.3 and not carrier.converged",
        "hold('reaction:R')",
        "robot.state == ERROR",
        "task.status == RUNNING_TASK",
    ],
)
def test_a_condition_must_not_look_at_what_the_reaction_changes(when: str, action: Action) -> None:
    assert codes(reaction(when, action)) == ["REACTION_RESTS_ON_ITSELF"]


def test_a_restart_must_not_depend_on_the_state_of_its_node() -> None:
    own = reaction("drive.state != active", Action.RESTART, part=DRIVE)

    assert codes(own) == ["REACTION_RESTS_ON_ITSELF"]


@pytest.mark.parametrize(
    "when",
    [
        "carrier.reachable",
        "carrier.errors.CHANGE_FAILED",
        "drive.mode == SLOW",
        "hold('reaction:OTHER')",
        "vehicle.speed_mps > 2",
        "task.progress > 0.5",
    ],
)
def test_a_condition_may_look_at_anything_else(when: str) -> None:
    assert codes(reaction(when, Action.MODE)) == []


def test_a_hold_changes_no_mode() -> None:
    assert codes(reaction("carrier.mode == SLOW", Action.HOLD)) == []


def test_who_only_tells_may_look_at_everything() -> None:
    assert codes(reaction("robot.state == ERROR and carrier.mode == SLOW", Action.TELL)) == []


def test_a_reaction_that_waits_for_a_person_may_look_at_everything() -> None:
    own = replace(reaction("robot.state == ERROR", Action.HOLD), until=Until.ACKNOWLEDGED)

    assert codes(own) == []


def test_the_conditions_of_errors_count_as_those_of_the_reaction() -> None:
    errors = {
        DRIVE: {
            "SHAKY": DeclaredError(when=Condition("carrier.mode == SLOW")),
            "WORN": DeclaredError(caused_by=(ErrorKey(DRIVE, "SHAKY"), ErrorKey(None, "ESTOP"))),
        }
    }

    assert codes(reaction("drive.errors.WORN", Action.MODE), errors=errors) == [
        "REACTION_RESTS_ON_ITSELF"
    ]
    assert codes(reaction("drive.errors.WORN", Action.MODE)) == []


def test_an_error_that_follows_counts_with_what_keeps_it_from_following() -> None:
    errors = {DRIVE: {"WORN": DeclaredError(unless=Condition("robot.state == ERROR"))}}

    assert codes(reaction("drive.errors.WORN", Action.HOLD), errors=errors) == [
        "REACTION_RESTS_ON_ITSELF"
    ]


def test_causes_of_an_error_that_is_detected_only_explain_it() -> None:
    worn = DeclaredError(
        when=Condition("battery_level < 0.3"), caused_by=(ErrorKey(DRIVE, "SHAKY"),)
    )
    errors = {DRIVE: {"WORN": worn, "SHAKY": DeclaredError(when=Condition("carrier.mode == SLOW"))}}

    assert codes(reaction("drive.errors.WORN", Action.MODE), errors=errors) == []


def test_holds_must_not_be_set_because_of_each_other() -> None:
    one = reaction("not hold('reaction:B')", Action.HOLD, "A")
    other = reaction("hold('reaction:A')", Action.STOP, "B")

    assert codes(one, other) == ["REACTION_RESTS_ON_ITSELF"]
    assert codes(one, replace(other, until=Until.ACKNOWLEDGED)) == []


def test_escalations_lead_in_one_direction() -> None:
    one = replace(reaction("true", Action.TELL, "A"), escalation=Escalation(seconds(1), "B"))
    other = replace(reaction("true", Action.HOLD, "B"), escalation=Escalation(seconds(1), "A"))

    assert codes(one, other) == ["REACTION_CIRCLE"]
    assert codes(one, replace(other, escalation=None)) == []
    assert codes(one) == ["UNKNOWN_REACTION"]
