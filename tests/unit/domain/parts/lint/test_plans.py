import pytest

from tests.support.lint_models import brief, guarded, node, system, told

FAST_NODE = node(default={"a": 1}, FAST={"a": 2}, SLOW={"a": 3})


def unreachable(*path: str) -> tuple[str, tuple[str, ...]]:
    return "UNREACHABLE_MODE", path


def test_a_mode_whose_systems_want_different_things_of_a_shared_part_is_told() -> None:
    findings = told(
        system(
            "top",
            default={"one": "active", "two": "active"},
            BOTH={"one": "active.A", "two": "active.B"},
        ),
        system("one", default={"n": "active"}, A={"n": "active.FAST"}),
        system("two", default={"n": "active"}, B={"n": "active.SLOW"}),
        FAST_NODE,
    )

    assert unreachable("top", "modes", "BOTH") in brief(findings)
    told_of = next(f for f in findings if f.code == "UNREACHABLE_MODE")
    assert told_of.message == (
        "top: no plan reaches BOTH: its parts require n to be active.FAST and active.SLOW"
    )


def test_a_mode_that_demands_one_that_no_plan_reaches_is_told_too() -> None:
    findings = told(
        system("higher", default={"top": "active"}, HIGH={"top": "active.MIXED"}),
        system(
            "top", default={"s": "active", "n": "active"}, MIXED={"s": "active.A", "n": "inactive"}
        ),
        system("s", default={"n": "active"}, A={"n": "active.FAST"}),
        FAST_NODE,
    )

    assert [f for f in brief(findings) if f[0] == "UNREACHABLE_MODE"] == [
        unreachable("higher", "modes", "HIGH"),
        unreachable("top", "modes", "MIXED"),
    ]


def test_a_mode_that_requires_itself_is_never_entered() -> None:
    findings = told(FAST_NODE, n={"FAST": guarded("n.mode == FAST")})

    assert brief(findings) == [unreachable("n", "modes", "FAST")]


def test_modes_that_require_each_other_are_never_entered() -> None:
    findings = told(
        FAST_NODE,
        node("m", default={"a": 1}, FAST={"a": 2}),
        n={"FAST": guarded("m.mode == FAST")},
        m={"FAST": guarded("n.mode in [FAST]")},
    )

    assert brief(findings) == [unreachable("n", "modes", "FAST"), unreachable("m", "modes", "FAST")]


@pytest.mark.parametrize(
    "requires", ["n.mode == SLOW", "n.mode != FAST", "n.mode in [FAST, SLOW]", "not n.mode == SLOW"]
)
def test_a_mode_that_is_entered_from_another_one_is_fine(requires: str) -> None:
    assert told(FAST_NODE, n={"FAST": guarded(requires)}) == []


def test_a_chain_of_modes_is_entered_one_after_the_other() -> None:
    assert (
        told(
            node(default={"a": 0}, A={"a": 1}, B={"a": 2}, C={"a": 3}),
            n={"A": guarded("n.mode == B"), "B": guarded("n.mode == C")},
        )
        == []
    )


def test_a_mode_that_demands_a_transitional_state_is_told_by_the_file_alone() -> None:
    findings = told(
        system("top", default={"s": "active"}, HIGH={"s": "active.ODD"}),
        system("s", default={"n": "active"}, ODD={"n": "activating"}),
        FAST_NODE,
    )

    assert brief(findings) == [unreachable("top", "modes", "HIGH")]


def test_a_mode_of_a_system_whose_part_can_never_enter_its_mode_is_told() -> None:
    findings = told(
        system("s", default={"n": "active"}, RACE={"n": "active.FAST"}),
        FAST_NODE,
        n={"FAST": guarded("battery_level > 1 and battery_level < 0")},
    )

    assert brief(findings) == [
        unreachable("s", "modes", "RACE"),
        (
            "GUARD_NEVER_HOLDS",
            ("n", "mode_settings", "FAST", "requires", "battery_level > 1 and battery_level < 0"),
        ),
    ]


def test_a_mode_whose_guards_contradict_those_of_the_modes_that_it_requires_is_told() -> None:
    findings = told(
        system("top", default={"s": "active"}, RACE={"s": "active.RACE"}),
        system("s", default={"n": "active"}, RACE={"n": "active.FAST"}),
        FAST_NODE,
        top={"RACE": guarded("battery_level > 0.8")},
        n={"FAST": guarded("battery_level < 0.3")},
    )

    assert brief(findings) == [unreachable("top", "modes", "RACE")]
    assert "contradict each other" in findings[0].message


def test_a_guard_sees_a_system_in_a_mode_to_which_its_parts_were_brought_one_by_one() -> None:
    findings = told(
        system("s", default={"n": "active"}, RACE={"n": "active.FAST"}),
        FAST_NODE,
        node("m", default={"a": 1}, FAST={"a": 2}),
        s={"RACE": guarded("s.mode == RACE")},
        m={"FAST": guarded("s.mode == RACE")},
    )

    assert brief(findings) == [unreachable("s", "modes", "RACE")]
