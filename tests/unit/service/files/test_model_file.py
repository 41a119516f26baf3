import gc
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.errors import InvalidModelError
from domain.findings import Finding
from domain.health.signals import default_signals
from service.files.model_file import check_model, load_model, read_model
from service.files.robot_file import RobotSettings
from service.files.text_file import UnreadableFileError
from tests.support.big_model import big_model, big_model_text
from tests.support.shared import PROJECT

EXAMPLE = PROJECT / "service" / "example" / "actuation.yaml"
ROBOT = EXAMPLE.read_text(encoding="utf-8")
MODELS = sorted((PROJECT / "examples" / "models").glob("*.yaml"))

BROKEN = """\
base:
  ros__parameters:
    type: system
    parts: [wheels, arm]
    modes:
      __DEFAULT__:
        wheels: active
        arm: Active
        horn: inactive
      FAST:
        wheels: active.FASTER
    rules:
      stop:
        if_target: active.SPEEDY
        if_part: [tail, inactive]
        new_target: inactive
wheels:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__:
        ros__parameters:
          speed: 0.1
      FAST:
        ros__parameters:
          sped: 0.9
arm:
  ros__parameters:
    modes:
      STRONG:
        ros__parameters:
          torque: &strong 0.2
      STRONGER:
        ros__parameters:
          torque: *strong
"""

GUARDED = """\
base:
  ros__parameters:
    type: system
    modes:
      __DEFAULT__: {wheels: active, arm: inactive}
      FAST: {wheels: active, arm: active}
    mode_settings:
      __ALL__: {fallback: __DEFAULT__, transition: {order: sequential}}
      FAST:
        requires: &guards ["battery_level >= 0.3"]
        invariants: *guards
        grace_s: 0.5
        transition: {after: {arm: [wheels]}, deadline_s: 20, on_failure: rollback}
wheels: {ros__parameters: {type: node}}
arm: {ros__parameters: {type: node}}
"""


def brief(finding: Finding) -> tuple[int | None, int | None, str]:
    return finding.line, finding.column, finding.code


def test_the_example_robot_is_that_of_d48_and_nothing_is_odd_about_it() -> None:
    loaded = load_model(EXAMPLE)

    assert loaded.warnings == ()
    assert (loaded.text, loaded.name) == (ROBOT, "actuation.yaml")
    assert loaded.model.parts == ("actuation", "drive_base", "manipulator")
    (system,) = loaded.model.systems.values()
    assert {m: {p: w.label for p, w in ws.items()} for m, ws in system.modes.items()} == {
        "__DEFAULT__": {"drive_base": "active.__DEFAULT__", "manipulator": "inactive"},
        "MODERATE": {"drive_base": "active.SLOW", "manipulator": "active.WEAK"},
        "PERFORMANCE": {"drive_base": "active.FAST", "manipulator": "active.STRONG"},
    }
    assert [rule.name for rule in system.rules] == [
        "degrade_from_MODERATE",
        "degrade_from_PERFORMANCE",
        "inactive_from_MODERATE",
        "inactive_from_PERFORMANCE",
    ]


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_the_models_among_the_examples_load_without_a_warning(path: Path) -> None:
    assert load_model(path).warnings == ()


def test_all_that_is_wrong_is_told_at_once_each_with_its_place() -> None:
    with pytest.raises(InvalidModelError) as caught:
        read_model(BROKEN)

    assert [brief(finding) for finding in caught.value.findings] == [
        (4, 5, "PARTS_DIFFER"),
        (8, 14, "UNKNOWN_STATE"),
        (9, 9, "UNKNOWN_PART"),
        (11, 9, "UNKNOWN_MODE"),
        (14, 9, "UNKNOWN_MODE"),
        (15, 9, "UNKNOWN_PART"),
        (26, 11, "PARAMETER_NOT_IN_DEFAULT"),
        (27, 1, "MISSING_TYPE"),
        (29, 5, "MISSING_DEFAULT_MODE"),
        (35, 19, "ALIAS"),
    ]
    assert caught.value.findings == check_model(BROKEN)


def test_a_warning_stands_at_the_mode_that_it_is_about() -> None:
    text = ROBOT.replace("max_torque: 0.15", "max_torque: 0.1")

    (warning,) = read_model(text).warnings

    assert (warning.code, warning.severity, warning.part) == (
        "MODES_ALIKE",
        "warning",
        "manipulator",
    )
    assert text.splitlines()[(warning.line or 0) - 1].strip() == "WEAK:"


def test_a_fault_of_a_mode_written_with_dots_is_placed_too() -> None:
    text = (
        "s: {ros__parameters: {type: system, modes.__DEFAULT__.n: active}}\n"
        "left: {n: {ros__parameters: {type: node}}}\n"
    )

    assert [brief(finding) for finding in check_model(text)] == [(1, 37, "UNKNOWN_PART")]


def test_a_cycle_is_placed_where_it_closes() -> None:
    text = (
        "a: {ros__parameters: {type: system, modes: {__DEFAULT__: {b: active}}}}\n"
        "b: {ros__parameters: {type: system, modes: {__DEFAULT__: {a: active}}}}\n"
    )

    assert [brief(finding) for finding in check_model(text)] == [(2, 59, "CYCLE")]


def test_a_model_without_parts_is_a_model() -> None:
    loaded = read_model("# nothing yet\n")

    assert loaded.model.parts == ()
    assert [brief(finding) for finding in loaded.warnings] == [(1, 1, "NO_PARTS")]


def test_a_fault_after_the_last_line_is_told_at_its_end() -> None:
    assert [brief(finding) for finding in check_model("a: [1,")] == [(1, 7, "YAML_SYNTAX")]


def test_of_thousands_of_faults_the_first_are_told_and_the_rest_counted() -> None:
    findings = check_model("".join(f"part_{number}: 1\n" for number in range(5_000)))

    assert len(findings) == 1_000
    assert brief(findings[0]) == (1, 1, "MISSING_ROS_PARAMETERS")
    assert (findings[-1].code, findings[-1].message) == ("MORE_FINDINGS", "and 4001 more")


def test_a_missing_file_is_said_to_be_missing(tmp_path: Path) -> None:
    with pytest.raises(UnreadableFileError, match=r"gone\.yaml"):
        load_model(tmp_path / "gone.yaml")


def test_the_garbage_collector_runs_again_after_a_model_was_read() -> None:
    check_model("a: [")

    assert gc.isenabled()


def test_a_model_built_of_yaml_is_the_one_built_directly() -> None:
    assert read_model(big_model_text(120)).model == big_model(120)


def test_a_tower_of_systems_is_refused_and_does_not_take_the_process_down() -> None:
    body = "{ros__parameters: {type: system, modes: {__DEFAULT__: {s%d: active}}}}"
    tower = "".join(f"s{level}: {body % (level + 1)}\n" for level in range(2_000))

    findings = check_model(f"{tower}s2000: {{ros__parameters: {{type: node}}}}\n")

    assert [finding.code for finding in findings] == ["TOO_DEEP"]


# --- whatever is in the file, the answer is a model or findings with a place ---

WORDS = st.sampled_from(
    ["*x", "&x", "<<", ": ", "- ", "[", "]", "{", "}", "\n", "\t", " ", "'", '"', "#", "---", "...",
     "|", ">", "? ", "%TAG", "!!int", "\x00", "\ufeff", "\u2028", "\x85", "\r", "é", "\ud800", "on",
     "null", "~", "active", "active.FAST", "ros__parameters", "modes", "type", "rules",
     "__DEFAULT__", "mode_settings", "__ALL__", "after", "sequence", "fallback", "FAST", "arm"]
)  # fmt: skip


def assert_harmless(text: str) -> None:
    findings = check_model(text)
    lines = text.replace("\r\n", "\n").replace("\r", "\n").replace("\x85", "\n")
    lengths = [
        len(line) for line in lines.replace("\u2028", "\n").replace("\u2029", "\n").split("\n")
    ]
    for finding in findings:
        assert finding.line is not None
        assert finding.column is not None
        assert 1 <= finding.line <= len(lengths)
        assert 1 <= finding.column <= lengths[finding.line - 1] + 1
    if any(finding.severity == "error" for finding in findings):
        with pytest.raises(InvalidModelError):
            read_model(text)
    else:
        assert read_model(text).warnings == findings


@given(st.text() | st.lists(WORDS).map("".join))
def test_any_text_is_a_model_or_is_complained_of(text: str) -> None:
    assert_harmless(text)


@given(st.data())
def test_a_model_with_a_slip_in_it_is_a_model_or_is_complained_of(data: st.DataObject) -> None:
    text = data.draw(
        st.sampled_from([ROBOT, BROKEN, GUARDED, *(path.read_text() for path in MODELS)])
    )
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        length = data.draw(st.integers(0, 30))
        text = text[:start] + data.draw(WORDS | st.just("")) + text[start + length :]

    assert_harmless(text)


@given(st.data())
def test_lines_moved_and_doubled_are_a_model_or_are_complained_of(data: st.DataObject) -> None:
    lines = data.draw(st.sampled_from([ROBOT, GUARDED])).splitlines(keepends=True)
    start = data.draw(st.integers(0, len(lines)))
    moved = lines[start : start + data.draw(st.integers(1, 10))]
    place = data.draw(st.integers(0, len(lines)))

    assert_harmless("".join([*lines[:place], *moved, *lines[place:]]))


# --- conditions ---


def guarded(condition: str) -> str:
    """Return a model with a condition; its scalar begins in line 10, column 20."""
    return GUARDED.replace('&guards ["battery_level >= 0.3"]', f"[{condition}]").replace(
        "        invariants: *guards\n", ""
    )


@pytest.mark.parametrize(
    ("condition", "severity", "code", "column"),
    [
        pytest.param("battery >= 0.3", "warning", "UNKNOWN_SIGNAL", 20, id="a signal"),
        pytest.param("estop and battery >= 1", "warning", "UNKNOWN_SIGNAL", 30, id="the second"),
        pytest.param("'estop and battery >= 1'", "warning", "UNKNOWN_SIGNAL", 31, id="in quotes"),
        pytest.param('"  tail.state == x"', "error", "UNKNOWN_PART", 23, id="a part, after blanks"),
        pytest.param("base.mode == SLOW", "error", "UNKNOWN_MODE", 33, id="a mode"),
        pytest.param("base.state == 3", "error", "WRONG_TYPE", 34, id="a number for a state"),
        pytest.param("battery_level >= full", "error", "WRONG_TYPE", 37, id="a word for a number"),
        pytest.param("battery_level > 1.5", "warning", "NEVER_TRUE", 36, id="out of range"),
        pytest.param("base.state ==", "error", "CONDITION_SYNTAX", 33, id="half a condition"),
    ],
)
def test_a_fault_in_a_condition_is_placed_at_its_character(
    condition: str, severity: str, code: str, column: int
) -> None:
    (finding, *_) = check_model(guarded(condition))

    assert (finding.severity, finding.code) == (severity, code)
    assert (finding.line, finding.column, finding.part) == (10, column, "base")


def test_a_fault_in_a_folded_condition_is_placed_at_its_start() -> None:
    text = guarded("x").replace("[x]", ">\n          estop and\n          batery > 1")

    (finding,) = check_model(text)
    assert brief(finding) == (10, 19, "UNKNOWN_SIGNAL")


def test_conditions_are_checked_though_there_are_other_errors() -> None:
    text = guarded("tail.state == active").replace("arm: inactive", "arm: innactive")

    assert [finding.code for finding in check_model(text)] == ["UNKNOWN_STATE", "UNKNOWN_PART"]


def test_with_the_signals_of_the_robot_an_unknown_one_is_an_error() -> None:
    text = guarded("battery >= 0.3")

    assert [f.severity for f in check_model(text)] == ["warning"]
    assert [f.severity for f in check_model(text, default_signals())] == ["error"]
    with pytest.raises(InvalidModelError):
        read_model(text, default_signals())


def test_a_signal_that_the_robot_declares_is_known() -> None:
    declared = RobotSettings.model_validate({"signals": {"battery": {"minimum": 0}}})

    assert check_model(guarded("battery >= 0.3"), declared.to_signal_settings()) == ()


def test_a_warning_about_a_guard_stands_at_the_guard_wherever_it_is_written() -> None:
    never = "battery_level > 0.8 and battery_level < 0.2"
    for_one = guarded(f"estop, {never}")
    for_all = GUARDED.replace("__ALL__: {", f"__ALL__: {{requires: [{never}], ")

    assert [brief(finding) for finding in check_model(for_one)] == [(10, 27, "GUARD_NEVER_HOLDS")]
    assert (8, 28, "GUARD_NEVER_HOLDS") in [brief(finding) for finding in check_model(for_all)]


def test_what_all_modes_share_is_told_once() -> None:
    never = "battery_level > 0.8 and battery_level < 0.2"
    text = GUARDED.replace("__ALL__: {", f"__ALL__: {{invariants: [{never}], ")

    assert [f.code for f in check_model(text)].count("GUARD_NEVER_HOLDS") == 1
