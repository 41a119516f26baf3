from tests.support.lint_models import brief, node, system, told


def test_systems_that_can_want_different_things_of_a_shared_part_are_told_once() -> None:
    findings = told(
        system("drive", default={"n": "active"}, RACE={"n": "active.FAST"}),
        system("work", default={"n": "active"}, REST={"n": "inactive"}, AWAY={"n": "finalized"}),
        node(default={"a": 1}, FAST={"a": 2}),
    )

    assert brief(findings) == [("CONFLICTING_SYSTEMS", ("work", "modes", "REST", "n"))]
    assert "drive in __DEFAULT__ requires active.__DEFAULT__" in findings[0].message
    assert "work in REST requires inactive" in findings[0].message


def test_systems_that_always_want_the_same_of_a_shared_part_are_fine() -> None:
    assert (
        told(
            system("one", default={"n": "active"}),
            system("two", default={"n": "active.__DEFAULT__"}),
            node(default={"a": 1}),
        )
        == []
    )
