"""What of a model is a device's own."""

import pytest

from domain.devices.own_signals import readable_signals
from domain.devices.sub_model import SubModel, sub_model
from domain.health.signals import SignalKind, SignalSettings, SignalSpec, default_signals
from domain.lifecycle import LifecycleState
from domain.state_and_mode import ModeName, PartName, StateAndMode
from service.files.model_file import read_model
from tests.support.models import ARM, BASE, actuation_model

LEFT, RIGHT, CHASSIS = PartName("left"), PartName("right"), PartName("chassis")
TEMPERATURE = SignalSettings(SignalSpec("motor_c", SignalKind.NUMBER))
EVERY = (*default_signals(), TEMPERATURE)

MODEL = """
robot: {ros__parameters: {type: system, parts: [chassis, arm],
  modes: {__DEFAULT__: {chassis: active, arm: active}},
  reactions: {WHOLE: {when: "left.state == inactive", action: state, target: inactive}}}}
chassis: {ros__parameters: {type: system, parts: [left, right],
  modes: {__DEFAULT__: {left: active, right: active}, SLOW: {left: active.SLOW, right: active}},
  rules: {OWN: {if_target: active.SLOW, if_part: [left, inactive], new_target: inactive},
          FOREIGN: {if_target: active.SLOW, if_part: [arm, inactive], new_target: inactive}},
  mode_settings: {SLOW: {requires: [BATTERY]}},
  errors: {LAME: {caused_by: [left.HOT, right.STUCK]},
           BLIND: {caused_by: [left.HOT, arm.HOT]},
           SAD: {caused_by: [right.DARK]}},
  reactions: {REST: {when: "left.errors.HOT", action: state, target: inactive},
              SLOWLY: {when: "left.errors.HOT", action: mode, target: active.SLOW}}}}
left: {ros__parameters: {type: node,
  modes: {__DEFAULT__: {ros__parameters: {v: 1}}, SLOW: {ros__parameters: {v: 2}}},
  errors: {HOT: {when: "motor_c > 80", suppressed_when: "hold.operator"}},
  reactions: {
    COOL: {when: "motor_c > 80", action: state, target: inactive},
    STOP: {when: "motor_c > 90", action: emergency_stop},
    HALT: {when: "motor_c > 90", action: stop},
    CHARGE: {when: "battery_level < 0.2", action: state, target: inactive},
    FAR: {when: "vehicle.speed_mps > 3", action: state, target: inactive},
    SAY: {when: "motor_c > 70", action: tell},
    AGAIN: {when: "left.errors.HOT", action: restart},
    STEP: {when: "motor_c > 85", action: state, target: inactive, escalate_after_s: 1,
           escalate_to: HALT}}}}
right: {ros__parameters: {type: node, errors: {STUCK: {}, DARK: {when: "task.progress > 0.5"}}}}
arm: {ros__parameters: {type: node, errors: {HOT: {}}}}
""".replace("BATTERY", '"battery_level >= 0.3"')


def cut(*nodes: PartName, read: tuple[str, ...] = ("motor_c",)) -> SubModel:
    model = read_model(MODEL, EVERY).model
    return sub_model(model, nodes, readable_signals(EVERY, read))


@pytest.fixture(scope="module")
def own() -> SubModel:
    return cut(LEFT, RIGHT)


def reason(own: SubModel, what: str) -> str:
    (found,) = [left.reason for left in own.left_out if left.what == what]
    return found


def test_a_device_runs_its_nodes_and_the_systems_of_these_alone(own: SubModel) -> None:
    assert own.model.parts == ("chassis", "left", "right")
    assert own.model.modes_of(CHASSIS) == ("__DEFAULT__", "SLOW")


def test_a_device_with_half_of_a_system_runs_no_system() -> None:
    assert cut(LEFT).model.parts == ("left",)


def test_the_nodes_of_the_example_are_separate() -> None:
    assert sub_model(actuation_model(), (ARM,), ()).model.parts == (ARM,)
    assert sub_model(actuation_model(), (BASE, ARM), ()).model == actuation_model()


def test_rules_about_foreign_parts_are_left_out(own: SubModel) -> None:
    assert [rule.name for rule in own.model.systems[CHASSIS].rules] == ["OWN"]
    assert reason(own, "rule FOREIGN of chassis") == "arm is not its own"


def test_errors_are_kept_that_are_found_at_the_device(own: SubModel) -> None:
    assert {part: [*named] for part, named in own.model.errors.items()} == {
        "chassis": ["LAME"],
        "left": ["HOT"],
        "right": ["STUCK"],
    }


def test_an_error_with_a_foreign_cause_is_left_out(own: SubModel) -> None:
    assert reason(own, "error BLIND of chassis") == "its cause arm.HOT is not its own"


def test_an_error_that_rests_on_the_task_is_left_out(own: SubModel) -> None:
    assert reason(own, "error DARK of right") == "task.progress is not its own"


def test_what_rests_on_an_error_that_is_left_out_is_left_out_too(own: SubModel) -> None:
    assert reason(own, "error SAD of chassis") == "its cause right.DARK is not its own"


def test_an_error_is_not_suppressed_by_what_the_device_does_not_know(own: SubModel) -> None:
    assert own.model.errors[LEFT]["HOT"].suppressed_when is None


def test_a_device_that_does_not_read_the_signal_does_not_find_the_error() -> None:
    assert LEFT not in cut(LEFT, RIGHT, read=()).model.errors


def test_reactions_are_kept_whose_conditions_and_targets_are_its_own(own: SubModel) -> None:
    assert {part: [*named] for part, named in own.model.reactions.items()} == {
        "chassis": ["REST"],
        "left": ["COOL", "STOP"],
    }


@pytest.mark.parametrize(
    ("reaction", "why"),
    [
        ("HALT", "its action stop is about the task, which is the supervisor's"),
        ("CHARGE", "battery_level is not its own"),
        ("FAR", "vehicle.speed_mps is not its own"),
        ("SAY", "it only tells, as the supervisor does"),
        ("AGAIN", "it leads back to a target, which the supervisor knows"),
        ("STEP", "it escalates to HALT, which is not its own"),
    ],
)
def test_a_reaction_of_the_supervisor_is_left_out(own: SubModel, reaction: str, why: str) -> None:
    assert reason(own, f"reaction {reaction} of left") == why


def test_a_reaction_whose_mode_the_device_cannot_judge_is_left_out(own: SubModel) -> None:
    expected = "whether chassis may be in SLOW rests on battery_level"

    assert reason(own, "reaction SLOWLY of chassis") == expected


def test_reactions_of_foreign_parts_are_no_matter_of_the_device(own: SubModel) -> None:
    assert not [left for left in own.left_out if "WHOLE" in left.what]


def test_a_foreign_guard_is_left_out_and_its_mode_not_pursued_alone(own: SubModel) -> None:
    active = LifecycleState.ACTIVE

    assert own.model.settings_of(CHASSIS, ModeName("SLOW")).requires == ()
    assert own.unjudged(CHASSIS, StateAndMode(active, ModeName("SLOW"))) is not None
    assert own.unjudged(CHASSIS, StateAndMode(active)) is None
    assert own.unjudged(CHASSIS, StateAndMode(LifecycleState.INACTIVE)) is None


def test_a_device_that_reads_the_battery_judges_the_guard() -> None:
    own = cut(LEFT, RIGHT, read=("motor_c", "battery_level"))

    assert own.unguarded == {}
    assert "SLOWLY" in own.model.reactions[CHASSIS]


def test_what_is_left_out_is_said_in_words(own: SubModel) -> None:
    assert own.left_out[0].words == "rule FOREIGN of chassis: arm is not its own"
