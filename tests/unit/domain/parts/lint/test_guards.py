import pytest

from domain.parts.mode_settings import ModeSettings
from tests.support.lint_models import brief, guarded, node, system, told

ARM = node("arm", default={"torque": 0.1}, STRONG={"torque": 0.2})
BASE = node("base", default={"speed": 0.1, "safe": True}, FAST={"speed": 0.9})
ROBOT = system(
    "carrier",
    default={"base": "active", "arm": "inactive"},
    WORK={"base": "active.FAST", "arm": "active.STRONG"},
    SAFE={"base": "inactive", "arm": "inactive"},
)


def guards(settings: ModeSettings, **others: ModeSettings) -> list[tuple[str, str]]:
    """Return code and last key of what is said about a mode of a system."""
    findings = told(ROBOT, ARM, BASE, carrier={"WORK": settings, **others})
    return [(code, path[-1]) for code, path in brief(findings)]


@pytest.mark.parametrize(
    "text",
    [
        "battery_level > 0.8 and battery_level < 0.3",
        "battery_level > 0.5 and battery_level <= 0.5",
        "battery_level == 0.5 and battery_level != 0.5",
        "signal_strength == CONNECTED and signal_strength == LOW_SIGNAL",
        "signal_strength not in [NOT_CONNECTED, CONNECTED, LOW_SIGNAL]",
        "arm.mode == STRONG and arm.state == inactive",
        "arm.state == active and not arm.reachable",
        "arm.mode == STRONG and arm.mode == __DEFAULT__",
        "error.ESTOP and not error.ESTOP",
        "robot.state != ERROR and robot.state != IDLE and robot.state != RUNNING",
        "base.parameters.speed > 0.5 and base.parameters.speed < 0.2",
        "not (estop or not estop)",
        "battery_level < 0.2 and (battery_level > 0.3 or battery_level > 0.4)",
        "false",
    ],
)
def test_a_condition_that_contradicts_itself_is_told(text: str) -> None:
    assert guards(guarded(text)) == [("GUARD_NEVER_HOLDS", text)]


@pytest.mark.parametrize(
    "text",
    [
        "battery_level > 0.8 or battery_level < 0.3",
        "battery_level >= 0.5 and battery_level <= 0.5",
        "arm.state == inactive and arm.mode != STRONG",
        "signal_strength != CONNECTED and signal_strength != LOW_SIGNAL",
        "arm.state == active and base.state == inactive",
        "battery_level < 0.2 and (temperature > 30 or battery_level > 0.4)",
        "not arm.reachable",
        "true",
    ],
)
def test_a_condition_that_can_hold_is_fine(text: str) -> None:
    assert guards(guarded(text)) == []


def test_guards_that_contradict_each_other_are_told_at_the_later_one() -> None:
    settings = guarded(["temperature > 0", "battery_level > 0.5"], "battery_level < 0.4")

    (finding,) = told(ROBOT, ARM, BASE, carrier={"WORK": settings})
    assert finding.path == ("carrier", "mode_settings", "WORK", "invariants", "battery_level < 0.4")
    assert finding.message == (
        "carrier in WORK: invariants 'battery_level < 0.4' never holds: "
        "it contradicts requires 'battery_level > 0.5'"
    )


def test_three_guards_that_contradict_each_other_only_together_are_told() -> None:
    settings = guarded(
        ["estop or battery_level > 0.5", "not estop", "battery_level < 0.5"],
    )

    assert guards(settings) == [("GUARD_NEVER_HOLDS", "battery_level < 0.5")]


@pytest.mark.parametrize(
    "invariant",
    [
        "arm.state == inactive",
        "arm.mode == __DEFAULT__",
        "base.parameters.speed <= 0.2",
        "carrier.mode == SAFE",
        "carrier.state != active",
    ],
)
def test_an_invariant_that_the_mode_itself_breaks_is_told(invariant: str) -> None:
    assert ("GUARD_NEVER_HOLDS", invariant) in guards(guarded(invariants=invariant))


@pytest.mark.parametrize(
    "invariant",
    ["arm.mode == STRONG", "base.parameters.speed > 0.5", "base.state == active", "arm.reachable"],
)
def test_an_invariant_that_the_mode_itself_keeps_is_fine(invariant: str) -> None:
    assert guards(guarded(invariants=invariant)) == []


def test_what_is_required_at_the_request_may_differ_from_what_the_mode_is() -> None:
    assert guards(guarded("arm.state == inactive")) == []


# --- fallbacks ---


@pytest.mark.parametrize(
    ("broken", "of_fallback"),
    [
        ("temperature < 50", "temperature < 50"),
        ("temperature < 50", "temperature < 40"),
        ("temperature < 50", "temperature < 40 and battery_level > 0.2"),
        ("not error.GPS_LOST", "battery_level > 0.2 and not error.GPS_LOST"),
        ("arm.mode in [STRONG, __DEFAULT__]", "arm.mode == STRONG"),
    ],
)
def test_a_fallback_that_needs_what_broke_is_told(broken: str, of_fallback: str) -> None:
    told_of = guards(
        guarded(invariants=broken, fallback="SAFE"), SAFE=guarded(invariants=of_fallback)
    )

    assert ("FALLBACK_NEEDS_THE_SAME", "fallback") in told_of


@pytest.mark.parametrize(
    ("broken", "of_fallback"),
    [
        ("temperature < 50", ""),
        ("temperature < 50", "temperature < 80"),
        ("temperature < 50 or estop", "temperature < 60"),
        ("arm.state == active", "not arm.reachable"),
    ],
)
def test_a_fallback_that_can_do_without_what_broke_is_fine(broken: str, of_fallback: str) -> None:
    told_of = guards(
        guarded(invariants=broken, fallback="SAFE"), SAFE=guarded(invariants=of_fallback)
    )

    assert "FALLBACK_NEEDS_THE_SAME" not in [code for code, _ in told_of]


def test_a_fallback_that_activates_the_node_that_fell_silent_is_told() -> None:
    settings = guarded(invariants="base.reachable", fallback="__DEFAULT__")

    assert guards(settings) == [("FALLBACK_NEEDS_THE_SAME", "fallback")]


def test_a_fallback_that_lets_the_silent_node_be_is_fine() -> None:
    assert guards(guarded(invariants="base.reachable", fallback="SAFE")) == []
