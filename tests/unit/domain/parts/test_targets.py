from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from domain.parts.targets import Displacement, Targets
from domain.snapshot import Because, EffectiveTarget
from domain.state_and_mode import ModeName, StateAndMode
from tests.support.models import ACTUATION, ARM, BASE, active, actuation_model


def test_nothing_is_pursued_of_a_part_that_nothing_was_asked_of() -> None:
    targets = Targets(ModeInference(actuation_model()))

    assert targets.asked(BASE) is None
    assert targets.effective(BASE) is None


def test_what_somebody_asks_is_pursued_because_it_was_requested() -> None:
    inference = ModeInference(actuation_model())
    targets = Targets(inference)

    changed = targets.ask({ACTUATION: active("PERFORMANCE"), BASE: active("FAST")})

    assert targets.asked(BASE) == active("FAST")
    pursued = EffectiveTarget(LifecycleState.ACTIVE, ModeName("FAST"), Because.REQUESTED)
    assert targets.effective(BASE) == pursued
    assert inference.target(BASE) == active("FAST")
    assert targets.asked(ARM) is None
    assert changed == {ACTUATION, BASE}, "none of them is where it should be from now on"


# --- displaced -----------------------------------------------------------------------------------


def displaced(rule: str, mode: str, because: Because = Because.RULE) -> Displacement:
    """Return what puts the whole robot into a mode."""
    targets = {ACTUATION: active(mode), BASE: active(mode), ARM: active(mode)}
    return Displacement(ACTUATION, targets, because, rule, cause=7)


def asked_for_fast() -> tuple[Targets, ModeInference]:
    inference = ModeInference(actuation_model())
    targets = Targets(inference)
    targets.ask(dict.fromkeys((ACTUATION, BASE, ARM), active("FAST")))
    return targets, inference


def test_a_displacement_is_in_force_and_what_was_asked_is_kept_apart() -> None:
    targets, inference = asked_for_fast()

    changed = targets.displace(displaced("slow_down", "SLOW"))

    assert changed == {ACTUATION, BASE, ARM}
    assert targets.asked(BASE) == active("FAST")
    assert inference.target(BASE) == active("SLOW")
    assert targets.effective(BASE) == EffectiveTarget(
        LifecycleState.ACTIVE, ModeName("SLOW"), Because.RULE, "slow_down", 7
    )


def test_its_end_puts_what_was_asked_in_force_again() -> None:
    targets, inference = asked_for_fast()
    slow = displaced("slow_down", "SLOW")
    targets.displace(slow)
    assert targets.without(slow)[BASE] == active("FAST")

    assert targets.end(slow) == {ACTUATION, BASE, ARM}
    assert inference.target(BASE) == active("FAST")
    assert targets.displacements == []


def test_of_two_rules_the_later_one_prevails_whoever_ends_first() -> None:
    targets, inference = asked_for_fast()
    first, second = displaced("first", "SLOW"), displaced("second", "WEAK")
    targets.displace(first)
    targets.displace(second)
    assert inference.target(BASE) == active("WEAK")
    assert targets.without(first) == {}, "its end changes nothing"
    assert targets.without(second)[BASE] == active("SLOW")

    targets.end(first)
    assert inference.target(BASE) == active("WEAK")
    targets.end(second)
    assert inference.target(BASE) == active("FAST")


def test_who_is_stronger_prevails_also_over_who_came_later() -> None:
    targets, inference = asked_for_fast()
    targets.displace(displaced("reacts", "WEAK", Because.REACTION))
    targets.displace(displaced("rules", "SLOW"))

    assert inference.target(BASE) == active("WEAK")


def test_a_request_for_the_system_ends_a_displacement_also_where_it_says_nothing() -> None:
    targets, inference = asked_for_fast()
    targets.displace(displaced("slow_down", "SLOW"))

    changed = targets.ask({ACTUATION: active("MODERATE")})

    assert targets.displacements == []
    assert inference.target(ACTUATION) == active("MODERATE")
    assert inference.target(BASE) == active("FAST")
    assert {BASE, ARM} <= changed


def test_a_request_for_a_part_takes_it_out_of_a_displacement() -> None:
    targets, inference = asked_for_fast()
    slow = displaced("slow_down", "SLOW")
    targets.displace(slow)
    targets.ask({BASE: active("__DEFAULT__")})
    assert inference.target(BASE) == active("__DEFAULT__")
    assert inference.target(ARM) == active("SLOW")

    targets.end(slow)
    assert inference.target(BASE) == active("__DEFAULT__")


def test_a_node_stays_as_it_is_where_its_target_was_set() -> None:
    targets, inference = asked_for_fast()
    resting = StateAndMode(LifecycleState.UNCONFIGURED)
    moved, was_requested = targets.let_stay(BASE, resting)
    assert BASE in moved
    assert was_requested
    assert targets.asked(BASE) == resting

    targets.displace(displaced("slow_down", "SLOW"))
    assert targets.let_stay(ARM, resting)[1] is False
    assert targets.asked(ARM) == active("FAST")
    assert inference.target(ARM) == resting


def test_all_parts_with_the_same_target_share_what_is_shown() -> None:
    targets, _ = asked_for_fast()
    targets.displace(displaced("slow_down", "SLOW"))

    assert targets.effective(BASE) is targets.effective(ARM)
