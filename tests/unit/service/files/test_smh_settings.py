import pytest

from domain.conditions.condition import Condition
from domain.parts.mode_settings import ModeSettings, OnFailure, TransitionSettings
from domain.parts.system_model import EVERY_MODE
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName
from domain.timebase import seconds
from service.files.model_file import check_model, read_model

ARM, BASE, CAMERA = PartName("arm"), PartName("base"), PartName("left/camera")
FAST, SAFE = ModeName("FAST"), ModeName("SAFE")
ROBOT = """\
carrier:
  ros__parameters:
    type: system
    modes:
      __DEFAULT__: {base: active, arm: inactive, left/camera: active}
      FAST: {base: active.FAST, arm: active}
      SAFE: {base: inactive, arm: inactive}
    mode_settings:
%s
base:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {speed: 0.1}}
      FAST: {ros__parameters: {speed: 0.9}}
arm: {ros__parameters: {type: node}}
left/camera: {ros__parameters: {type: node}}
other: {ros__parameters: {type: node}}
"""


def robot(settings: str) -> str:
    """Return a model; the text of `settings` begins in line 9."""
    lines = settings.strip("\n").splitlines()
    return ROBOT % "\n".join(f"      {line}" for line in lines)


def read(settings: str) -> dict[ModeName, ModeSettings]:
    return dict(read_model(robot(settings)).model.mode_settings[PartName("carrier")])


def told(settings: str) -> list[tuple[str, int | None, int | None]]:
    return [(f.code, f.line, f.column) for f in check_model(robot(settings))]


def test_all_that_can_be_set_is_read() -> None:
    settings = read(
        """
FAST:
  requires: ["battery_level >= 0.3", "base.state != finalized"]
  invariants: temperature < 50
  grace_s: 0.5
  fallback: SAFE
  transition:
    order: sequential
    sequence: [arm, base, left/camera]
    deadline_s: 20
    on_failure: rollback
"""
    )

    assert settings[FAST] == ModeSettings(
        requires=(Condition("battery_level >= 0.3"), Condition("base.state != finalized")),
        invariants=(Condition("temperature < 50"),),
        grace=seconds(0.5),
        fallback=SAFE,
        transition=TransitionSettings(
            after={BASE: (ARM,), CAMERA: (BASE,)},
            deadline=seconds(20),
            on_failure=OnFailure.ROLLBACK,
        ),
    )


def test_dotted_names_are_read_as_nested_ones() -> None:
    assert read("FAST.transition.after.arm: base")[FAST].transition.after == {ARM: (BASE,)}


def test_a_sequence_without_names_is_the_order_of_the_file() -> None:
    settings = read("FAST: {transition: {order: sequential}}")

    assert settings[FAST].transition.after == {ARM: (BASE,), CAMERA: (ARM,)}


def test_settings_of_all_modes_fill_in_key_by_key() -> None:
    settings = read(
        """
__ALL__:
  requires: ["battery_level >= 0.3"]
  grace_s: 2
  transition: {order: sequential, deadline_s: 20}
FAST:
  requires: ["battery_level >= 0.8"]
  transition: {on_failure: stop}
"""
    )

    fast, every = settings[FAST], settings[EVERY_MODE]
    assert (fast.requires, every.requires) == (
        (Condition("battery_level >= 0.8"),),
        (Condition("battery_level >= 0.3"),),
    )
    assert (fast.grace, fast.transition.deadline) == (seconds(2), seconds(20))
    assert fast.transition.after == every.transition.after == {ARM: (BASE,), CAMERA: (ARM,)}
    assert (fast.transition.on_failure, every.transition.on_failure) == (
        OnFailure.STOP,
        OnFailure.CONTINUE,
    )


def test_a_sequence_for_all_modes_is_that_of_the_modes_that_are_sequential() -> None:
    settings = read(
        """
__ALL__: {transition: {sequence: [left/camera, arm, base]}}
FAST: {transition: {order: sequential}}
"""
    )

    assert settings[FAST].transition.after == {ARM: (CAMERA,), BASE: (ARM,)}
    assert settings[EVERY_MODE].transition.after == {}


def test_a_sequence_for_all_modes_of_which_none_is_sequential_is_told() -> None:
    settings = "__ALL__: {transition: {sequence: [left/camera, arm, base]}}\nFAST: {grace_s: 1}"

    assert told(settings) == [("ORDER_CONFLICT", 9, 30)]


def test_the_fallback_of_all_modes_is_not_its_own() -> None:
    model = read_model(robot("__ALL__: {fallback: SAFE, grace_s: 1}")).model

    modes = (DEFAULT_MODE, FAST, SAFE)
    settings = [model.settings_of(PartName("carrier"), mode) for mode in modes]
    assert [own.fallback for own in settings] == [SAFE, SAFE, None]
    assert {own.grace for own in settings} == {seconds(1)}


def test_a_mode_that_asks_for_nothing_asks_for_nothing_though_all_others_do() -> None:
    text = robot("__ALL__: {requires: 'battery_level > 0'}\nSAFE: {requires: []}")

    assert [finding.code for finding in check_model(text)] == ["NOT_FOR_CPP"]
    assert read_model(text).model.settings_of(PartName("carrier"), SAFE).requires == ()


def test_a_node_has_guards_and_deadlines() -> None:
    text = robot("FAST: {grace_s: 1}") + (
        "lidar: {ros__parameters: {type: node, modes: {__DEFAULT__: {ros__parameters: {hz: 10}}},"
        " mode_settings: {__DEFAULT__: {requires: 'battery_level > 0',"
        " transition: {deadline_s: 3}}}}}\n"
    )

    settings = read_model(text).model.mode_settings[PartName("lidar")][DEFAULT_MODE]
    assert settings.requires == (Condition("battery_level > 0"),)
    assert settings.transition.deadline == seconds(3)


@pytest.mark.parametrize(
    ("settings", "code", "line", "column"),
    [
        pytest.param("FASTER: {grace_s: 1}", "UNKNOWN_MODE", 9, 7, id="an unknown mode"),
        pytest.param("FAST: 5", "NOT_A_BLOCK", 9, 7, id="a mode without keys"),
        pytest.param("FAST: {require: x}", "UNKNOWN_KEY", 9, 14, id="an unknown key"),
        pytest.param("FAST: {guard: {x: 1, y: 2}}", "UNKNOWN_KEY", 9, 14, id="an unknown block"),
        pytest.param(
            "FAST: {transition: {sequnce: [arm]}}", "UNKNOWN_KEY", 9, 27, id="in transition"
        ),
        pytest.param("FAST: {transition: fast}", "NOT_A_BLOCK", 9, 14, id="transition: a word"),
        pytest.param("FAST: {grace_s: {x: 1}}", "INVALID_VALUE", 9, 24, id="a map for a number"),
        pytest.param("FAST: {grace_s: -1}", "INVALID_VALUE", 9, 23, id="a negative time"),
        pytest.param("FAST: {transition: {deadline_s: .inf}}", "INVALID_VALUE", 9, 39, id="no end"),
        pytest.param(
            "FAST: {transition: {deadline_s: 0}}", "INVALID_VALUE", 9, 39, id="no time at all"
        ),
        pytest.param(
            "FAST: {transition: {deadline_s: {a: 1}}}", "INVALID_VALUE", 9, 40, id="a map"
        ),
        pytest.param(
            "FAST: {transition: {on_failure: retry}}", "INVALID_VALUE", 9, 39, id="a policy"
        ),
        pytest.param("FAST: {transition: {order: random}}", "INVALID_VALUE", 9, 34, id="an order"),
        pytest.param("FAST: {fallback: SAVE}", "UNKNOWN_MODE", 9, 24, id="an unknown fallback"),
        pytest.param("FAST: {fallback: FAST}", "FALLBACK_CIRCLE", 9, 14, id="its own fallback"),
        pytest.param(
            "FAST: {fallback: SAFE}\nSAFE: {fallback: FAST}", "FALLBACK_CIRCLE", 10, 14, id="circle"
        ),
        pytest.param(
            "__ALL__: {fallback: SAFE}\nSAFE: {fallback: FAST}",
            "FALLBACK_CIRCLE",
            9,
            17,
            id="a circle through the fallback of all modes",
        ),
        pytest.param(
            'FAST: {invariants: ["temperature < 50", "not carrier.errors.INVARIANT_BROKEN"]}',
            "INVARIANT_CIRCLE",
            9,
            47,
            id="an invariant that rests on itself",
        ),
        pytest.param(
            "FAST: {transition: {order: sequential, sequence: [arm, bas]}}",
            "UNKNOWN_PART",
            9,
            62,
            id="an unknown part in a sequence",
        ),
        pytest.param(
            "FAST: {transition: {order: sequential, sequence: [arm, other]}}",
            "UNKNOWN_PART",
            9,
            62,
            id="a part of another system in a sequence",
        ),
        pytest.param(
            "FAST: {transition: {order: sequential, sequence: [arm, base, arm]}}",
            "INVALID_VALUE",
            9,
            56,
            id="a part twice in a sequence",
        ),
        pytest.param(
            "FAST: {transition: {after: {arm: [wheel]}}}", "UNKNOWN_PART", 9, 41, id="before"
        ),
        pytest.param(
            "FAST: {transition: {after: {wheel: [arm]}}}", "UNKNOWN_PART", 9, 35, id="after"
        ),
        pytest.param("FAST: {transition: {after: arm}}", "NOT_A_BLOCK", 9, 27, id="after: a word"),
        pytest.param(
            "FAST: {transition: {after: {arm: base, base: arm}}}", "DAG_CYCLE", 9, 46, id="cycle"
        ),
        pytest.param(
            "FAST: {transition: {after: {arm: arm}}}", "DAG_CYCLE", 9, 35, id="after itself"
        ),
        pytest.param(
            "FAST: {transition: {after: {arm: base}, order: simultaneous}}",
            "ORDER_CONFLICT",
            9,
            47,
            id="a DAG and an order",
        ),
        pytest.param(
            "FAST: {transition: {sequence: [base, arm, left/camera]}}",
            "ORDER_CONFLICT",
            9,
            27,
            id="a sequence without an order",
        ),
        pytest.param(
            "FAST: {transition: {order: sequential, sequence: [arm, base]}}",
            "SEQUENCE_INCOMPLETE",
            9,
            46,
            id="a sequence that lacks a part",
        ),
        pytest.param("FAST: {requires: ''}", "CONDITION_SYNTAX", 9, 25, id="an empty condition"),
        pytest.param(
            "FAST: {requires: [estop, temperature >]}", "CONDITION_SYNTAX", 9, 45, id="half of one"
        ),
        pytest.param("FAST: {requires: 'a => 1'}", "CONDITION_SYNTAX", 9, 27, id="no operator"),
        pytest.param(
            f"FAST: {{requires: '{'x' * 501}'}}", "CONDITION_SYNTAX", 9, 525, id="a long condition"
        ),
        pytest.param(
            f"FAST: {{requires: [{', '.join(['battery_level > 0'] * 51)}]}}",
            "TOO_LARGE",
            9,
            14,
            id="too many",
        ),
    ],
)
def test_what_is_wrong_is_told_with_its_place(
    settings: str, code: str, line: int, column: int
) -> None:
    assert told(settings) == [(code, line, column)]


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ("FASTT: {grace_s: 1}", "did you mean FAST?"),
        ("FAST: {require: x}", "did you mean requires?"),
        ("FAST: {fallback: SAVE}", "did you mean SAFE?"),
        ("FAST: {transition: {after: {bas: arm}}}", "did you mean base?"),
        ("FAST: {transition: {after: {other: arm}}}", "other is not a part of carrier"),
        ("FAST: {xyz: 1}", "known: requires, invariants, grace_s, fallback, transition"),
    ],
)
def test_what_was_probably_meant_is_told(settings: str, words: str) -> None:
    (finding,) = check_model(robot(settings))

    assert words in finding.message


def test_all_unknown_parts_of_a_list_are_told() -> None:
    settings = "FAST: {transition: {after: {arm: [bas, base, cam], camera: [eye]}}}"

    assert told(settings) == [("UNKNOWN_PART", 9, c) for c in (41, 52, 58, 67)]


def test_settings_that_are_no_block_are_told() -> None:
    text = ROBOT.replace("    mode_settings:\n%s\n", "    mode_settings: 5\n")

    assert [(f.code, f.line, f.column) for f in check_model(text)] == [("NOT_A_BLOCK", 8, 5)]


def test_a_node_has_no_parts_to_order() -> None:
    text = robot("FAST: {grace_s: 1}") + (
        "lidar: {ros__parameters: {type: node, modes: {__DEFAULT__: {ros__parameters: {hz: 10}}},"
        "\n mode_settings: {__DEFAULT__: {transition: {order: sequential}}}}}\n"
    )

    assert [(f.code, f.line, f.column) for f in check_model(text)] == [("ORDER_OF_A_NODE", 20, 45)]


def test_a_part_without_modes_has_no_settings() -> None:
    text = robot("FAST: {grace_s: 1}") + (
        "lidar: {ros__parameters: {type: node, mode_settings: {__ALL__: {grace_s: 1}}}}\n"
    )

    (finding,) = check_model(text)
    assert (finding.code, finding.line, finding.column) == ("UNKNOWN_MODE", 19, 55)
    assert "lidar has no modes" in finding.message
