import pytest

from domain.conditions.condition import Condition
from domain.lifecycle import LifecycleState
from domain.parts.declared_reactions import Budget, DeclaredReaction, Escalation
from domain.reaction_terms import Action, Arm, Until
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from domain.timebase import seconds
from service.files.model_file import check_model, read_model, with_signals

CARRIER, LIDAR = PartName("carrier"), PartName("lidar")
ROBOT = """\
carrier:
  ros__parameters:
    type: system
    modes:
      __DEFAULT__: {lidar: active, drive: inactive}
      SLOW: {drive: active.SLOW}
    reactions:
%s
lidar: {ros__parameters: {type: node}}
drive:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {speed: 0.9}}
      SLOW: {ros__parameters: {speed: 0.1}}
"""


def robot(reactions: str) -> str:
    """Return a model; the text of `reactions` begins in line 8."""
    lines = reactions.strip("\n").splitlines()
    return ROBOT % "\n".join(f"      {line}" for line in lines)


def read(reactions: str) -> dict[str, DeclaredReaction]:
    return dict(read_model(robot(reactions)).model.reactions[CARRIER])


def told(reactions: str) -> list[tuple[str, int | None, int | None]]:
    return [(f.code, f.line, f.column) for f in check_model(robot(reactions))]


def test_all_that_a_reaction_can_say_is_read() -> None:
    reactions = read(
        """
LIMP:
  when: lidar.errors.DEVIATES
  for_s: 0.5
  action: mode
  target: active.SLOW
  until: acknowledged
  arm: passive
  at_most: 5
  in_s: 30
  on_exhausted: stop
  escalate_after_s: 10
  escalate_to: HALT
HALT: {when: "not lidar.reachable", action: stop}
"""
    )

    assert list(reactions) == ["LIMP", "HALT"]
    assert reactions["LIMP"] == DeclaredReaction(
        "LIMP",
        CARRIER,
        Condition("lidar.errors.DEVIATES"),
        Action.MODE,
        seconds(0.5),
        StateAndMode(LifecycleState.ACTIVE, ModeName("SLOW")),
        Until.ACKNOWLEDGED,
        Arm.PASSIVE,
        Budget(5, seconds(30)),
        Action.STOP,
        Escalation(seconds(10), "HALT"),
    )


def test_a_reaction_acts_three_times_a_minute_and_then_holds_unless_it_says_otherwise() -> None:
    rest = read('REST: {when: "temperature > 50", action: state, target: inactive}')["REST"]

    assert rest == DeclaredReaction(
        "REST",
        CARRIER,
        Condition("temperature > 50"),
        Action.STATE,
        target=StateAndMode(LifecycleState.INACTIVE),
        budget=Budget(3, seconds(60)),
        on_exhausted=Action.HOLD,
    )


def test_active_means_the_default_mode_of_a_part_that_has_modes() -> None:
    wake = read('WAKE: {when: "temperature > 50", action: state, target: active}')["WAKE"]

    assert wake.target == StateAndMode(LifecycleState.ACTIVE, DEFAULT_MODE)


def test_reactions_are_in_the_order_of_the_file() -> None:
    text = robot('A: {when: "true", action: tell}') + (
        'z: {ros__parameters: {type: node, reactions: {Z: {when: "true", action: restart}}}}\n'
        'y: {ros__parameters: {type: system, reactions: {Y: {when: "true", action: tell}}}}\n'
    )

    assert list(read_model(text).model.reactions) == [CARRIER, "z", "y"]


REJECTED = {
    "LIMP: {action: tell}": ("INCOMPLETE_REACTION", 8, 7),
    'LIMP: {when: "true"}': ("INCOMPLETE_REACTION", 8, 7),
    'LIMP: {when: "true", action: mode}': ("INCOMPLETE_REACTION", 8, 7),
    'LIMP: {when: "true", action: tell, escalate_to: LIMP}': ("INCOMPLETE_REACTION", 8, 42),
    'LIMP: {when: "true", action: jump}': ("INVALID_VALUE", 8, 36),
    'LIMP: {when: "true", action: tell, for: 3}': ("UNKNOWN_KEY", 8, 42),
    'LIMP: {when: "true", action: tell, for_s: soon}': ("INVALID_VALUE", 8, 49),
    'LIMP: {when: "true", action: tell, until: tomorrow}': ("INVALID_VALUE", 8, 49),
    'LIMP: {when: "true", action: tell, arm: maybe}': ("INVALID_VALUE", 8, 47),
    'LIMP: {when: "true and", action: tell}': ("CONDITION_SYNTAX", 8, 29),
    'LIMP: {when: "lidar.errors.NONE", action: tell}': ("UNKNOWN_ERROR", 8, 21),
    'LIMP: {when: "true", action: mode, target: actve.SLOW}': ("UNKNOWN_STATE", 8, 50),
    'LIMP: {when: "true", action: mode, target: active.SLOWW}': ("UNKNOWN_MODE", 8, 42),
    'LIMP: {when: "true", action: mode, target: [a]}': ("INVALID_VALUE", 8, 50),
    'LIMP: {when: "true", action: mode, target: inactive}': ("INVALID_REACTION", 8, 42),
    'LIMP: {when: "true", action: state, target: active.SLOW}': ("INVALID_REACTION", 8, 43),
    'LIMP: {when: "true", action: state, target: activating}': ("INVALID_REACTION", 8, 43),
    'LIMP: {when: "true", action: hold, target: inactive}': ("INVALID_REACTION", 8, 42),
    'LIMP: {when: "true", action: hold, at_most: 2}': ("INVALID_REACTION", 8, 42),
    'LIMP: {when: "true", action: restart}': ("INVALID_REACTION", 8, 28),
    'LIMP: {when: "true", action: state, target: inactive, at_most: 0}': (
        "INVALID_VALUE",
        8,
        70,
    ),
    'LIMP: {when: "true", action: state, target: inactive, on_exhausted: mode}': (
        "INVALID_REACTION",
        8,
        61,
    ),
    'LIMP: {when: "true", action: tell, escalate_after_s: 1, escalate_to: X}': (
        "UNKNOWN_REACTION",
        8,
        63,
    ),
    'LIMP: {when: "true", action: tell, escalate_after_s: 1, escalate_to: LIMP}': (
        "REACTION_CIRCLE",
        8,
        63,
    ),
    '"LIMP HOME": {when: "true", action: tell}': ("INVALID_NAME", 8, 7),
    "LIMP: tell": ("NOT_A_BLOCK", 8, 7),
    'LIMP: {when: "true", action: tell, for_s: {much: 1}}': ("INVALID_VALUE", 8, 50),
}


@pytest.mark.parametrize("reaction", REJECTED)
def test_what_cannot_be_done_is_told_at_its_place(reaction: str) -> None:
    found = told(reaction)

    assert REJECTED[reaction] in found
    codes = [code for code, _, _ in found]
    assert codes.count(REJECTED[reaction][0]) == 1


def test_reactions_that_are_no_block_are_told() -> None:
    text = "lidar: {ros__parameters: {type: node, reactions: 3}}"

    assert [f.code for f in check_model(text)] == ["NOT_A_BLOCK"]


def test_two_parts_cannot_have_reactions_of_the_same_name() -> None:
    text = robot('HALT: {when: "true", action: stop}') + (
        'z: {ros__parameters: {type: node, reactions: {HALT: {when: "true", action: hold}}}}\n'
    )

    assert [f.code for f in check_model(text)] == ["DUPLICATE_REACTION"]


def test_all_that_is_wrong_with_a_model_is_told_at_once() -> None:
    found = told(
        """
LIMP: {when: "carrier.mode == SLOW", action: mode, target: active.NONE, colour: red}
HALT: {when: "true"}
"""
    )

    assert [code for code, _, _ in found] == [
        "REACTION_RESTS_ON_ITSELF",
        "UNKNOWN_MODE",
        "UNKNOWN_KEY",
        "INCOMPLETE_REACTION",
    ]


def test_an_unknown_signal_is_a_warning_until_the_robot_file_is_known() -> None:
    text = robot('WARM: {when: "motor_temperature > 80", action: tell}')
    loaded = read_model(text)

    assert [(f.severity, f.code) for f in loaded.warnings] == [("warning", "UNKNOWN_SIGNAL")]
    with pytest.raises(Exception, match="motor_temperature"):
        with_signals(loaded, [])


def test_what_the_yaml_reader_of_ros_2_rejects_is_a_warning() -> None:
    found = told('LIMP: {when: "not lidar.reachable", action: tell, target: ~}')

    assert [code for code, _, _ in found] == ["NOT_FOR_CPP"]
