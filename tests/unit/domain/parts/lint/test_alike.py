from tests.support.lint_models import brief, node, system, told


def test_two_modes_of_a_node_with_the_same_parameters_cannot_be_told_apart() -> None:
    # As in D4.8, where WEAK has the torque of the default mode.
    findings = told(node(default={"torque": 0.1}, WEAK={"torque": 0.1}, STRONG={"torque": 0.2}))

    assert brief(findings) == [("MODES_ALIKE", ("n", "modes", "WEAK"))]
    assert "WEAK is the same as __DEFAULT__" in findings[0].message


def test_parameters_of_different_types_tell_modes_apart() -> None:
    findings = told(node(default={"rate": 1}, FINE={"rate": 1.0}))

    assert "MODES_ALIKE" not in [finding.code for finding in findings]


def test_two_modes_of_a_system_that_want_the_same_cannot_be_told_apart() -> None:
    findings = told(
        system(default={"n": "active"}, SAME={"n": "active.__DEFAULT__"}, REST={"n": "inactive"}),
        node(default={"a": 1}),
    )

    assert brief(findings) == [("MODES_ALIKE", ("s", "modes", "SAME"))]


def test_modes_of_systems_that_name_modes_that_are_alike_are_alike_too() -> None:
    findings = told(
        system("top", default={"s": "active"}, HIGH={"s": "active.SOFT"}),
        system("s", default={"n": "active"}, SOFT={"n": "active.WEAK"}),
        node(default={"torque": 0.1}, WEAK={"torque": 0.1}),
    )

    assert brief(findings) == [
        ("MODES_ALIKE", ("n", "modes", "WEAK")),
        ("MODES_ALIKE", ("top", "modes", "HIGH")),
        ("MODES_ALIKE", ("s", "modes", "SOFT")),
    ]


def test_a_mode_that_differs_in_one_part_is_not_alike() -> None:
    assert (
        told(
            system(
                "s", default={"n": "active", "m": "active"}, REST={"n": "active", "m": "inactive"}
            ),
            node(default={"a": 1}),
            node("m", default={"a": 1}),
        )
        == []
    )


def test_what_is_told_says_what_follows_from_it() -> None:
    (alike,) = told(node(default={"a": 1}, X={"a": 1}))
    (differs,) = told(node(default={"a": 0.5}, X={"a": 1}))
    (never,) = told(node(default={"a": 0.5}, X={"a": float("nan")}))

    assert alike.message == "n: X is the same as __DEFAULT__; inference cannot tell the two apart"
    assert differs.message == (
        "n in X: a is integer here and double in __DEFAULT__; "
        "a node accepts only one of these types"
    )
    assert never.message == (
        "n in X: a holds NaN, which never equals anything; "
        "the mode is never inferred from its parameters"
    )
