"""Invariants that rest on their own being broken are errors; others that name errors are not."""

import pytest

from domain.conditions.condition import Condition
from domain.parts.declared_errors import DeclaredError
from domain.parts.invariant_circles import invariant_circles
from domain.parts.mode_settings import ModeSettings
from domain.state_and_mode import ModeName, PartName

ARM, BASE = PartName("arm"), PartName("base")
FAST = ModeName("FAST")


def _invariants(**of_parts: str) -> dict[PartName, dict[ModeName, ModeSettings]]:
    return {
        PartName(part): {FAST: ModeSettings(invariants=(Condition(text),))}
        for part, text in of_parts.items()
    }


@pytest.mark.parametrize("text", ["arm.errors.INVARIANT_BROKEN", "not arm.errors.INVARIANT_BROKEN"])
def test_an_invariant_that_names_its_own_being_broken_is_an_error(text: str) -> None:
    (finding,) = invariant_circles(_invariants(arm=text), {})
    assert (finding.code, finding.path) == (
        "INVARIANT_CIRCLE",
        ("arm", "mode_settings", "FAST", "invariants", text),
    )


def test_two_invariants_that_name_each_others_being_broken_are_one_error() -> None:
    settings = _invariants(
        arm="base.errors.INVARIANT_BROKEN", base="not arm.errors.INVARIANT_BROKEN"
    )
    (finding,) = invariant_circles(settings, {})
    assert finding.message == (
        "invariants of arm rest on their own being broken: "
        "arm.INVARIANT_BROKEN > base.INVARIANT_BROKEN > arm.INVARIANT_BROKEN"
    )


def test_a_circle_may_lead_through_an_error_that_the_model_declares() -> None:
    late = DeclaredError(when=Condition("arm.errors.INVARIANT_BROKEN"))
    settings = _invariants(arm="not base.errors.LATE")
    (finding,) = invariant_circles(settings, {BASE: {"LATE": late}})
    assert finding.code == "INVARIANT_CIRCLE"


def test_a_row_of_invariants_is_no_circle() -> None:
    settings = _invariants(arm="not base.errors.INVARIANT_BROKEN", base="not base.errors.DEVIATES")
    assert list(invariant_circles(settings, {})) == []
