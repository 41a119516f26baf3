from domain.lifecycle import LifecycleState
from domain.parts.lint.warning import meaning, warning
from domain.state_and_mode import DEFAULT_MODE, ModeName, StateAndMode

ACTIVE, INACTIVE = LifecycleState.ACTIVE, LifecycleState.INACTIVE


def test_a_warning_is_about_the_part_that_its_path_begins_with() -> None:
    finding = warning("ODD", "this is odd", "arm", "modes", "FAST")

    assert (finding.severity, finding.part, finding.path) == (
        "warning",
        "arm",
        ("arm", "modes", "FAST"),
    )


def test_pairs_that_agree_have_one_meaning() -> None:
    assert meaning(StateAndMode(ACTIVE)) == meaning(StateAndMode(ACTIVE, DEFAULT_MODE))
    assert meaning(StateAndMode(INACTIVE, ModeName("FAST"))) == meaning(StateAndMode(INACTIVE))
    assert meaning(StateAndMode(ACTIVE, ModeName("FAST"))) != meaning(StateAndMode(ACTIVE))
