from domain.parts.lint.budget import Budget
from domain.parts.lint.demands import Demands, conflicting_demands, contradict
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from tests.support.lint_models import model_of, node, system

FAST, N = ModeName("FAST"), PartName("n")
MODEL = model_of(
    system(
        "top",
        default={"s": "active", "n": "inactive"},
        FAST={"s": "active.FAST"},
        OFF={"s": "inactive"},
    ),
    system("s", default={"n": "active", "m": "active"}, FAST={"n": "active.FAST", "m": "active"}),
    node(default={"a": 1}, FAST={"a": 2}),
    node("m"),
    node("other"),
)


def labels(part: str, mode: str, below: str) -> set[str]:
    pairs = Demands(MODEL, Budget()).of_mode(PartName(part), ModeName(mode), PartName(below))
    return {pair.label for pair in pairs}


def test_a_mode_demands_what_it_says_of_a_part() -> None:
    assert labels("s", "FAST", "n") == {"active.FAST"}


def test_a_mode_demands_of_parts_of_parts_what_their_modes_say() -> None:
    assert labels("top", "FAST", "m") == {"active.__DEFAULT__"}


def test_a_part_that_is_reached_on_two_ways_has_two_demands() -> None:
    assert labels("top", "__DEFAULT__", "n") == {"active.__DEFAULT__", "inactive"}


def test_a_system_that_rests_demands_rest_of_all_its_parts() -> None:
    assert labels("top", "OFF", "m") == {"inactive"}


def test_a_mode_demands_itself_of_its_part_and_nothing_of_others() -> None:
    assert labels("n", "FAST", "n") == {"active.FAST"}
    assert labels("s", "FAST", "other") == set()


def test_demands_contradict_each_other_unless_one_state_meets_all() -> None:
    def pairs(*names: str) -> frozenset[StateAndMode]:
        return frozenset(map(StateAndMode.parse, names))

    assert contradict(pairs("active", "inactive"))
    assert contradict(pairs("active.A", "active.B"))
    assert not contradict(pairs("inactive", "unconfigured"))
    assert not contradict(pairs("active.A"))
    assert not contradict(frozenset())


def test_a_demand_of_the_default_mode_is_one_however_it_is_written() -> None:
    demands = Demands(MODEL, Budget())

    assert demands.of_pair(N, StateAndMode.parse("active"), N) == demands.of_mode(
        N, DEFAULT_MODE, N
    )


def test_the_lowest_modes_with_demands_that_contradict_each_other_are_told() -> None:
    found = conflicting_demands(MODEL, Demands(MODEL, Budget()), Budget())

    assert found == {
        ("top", "__DEFAULT__"): "its parts require n to be active.__DEFAULT__ and inactive",
    }


def test_without_a_budget_nothing_is_demanded() -> None:
    assert Demands(MODEL, Budget(0)).of_mode(PartName("s"), FAST, N) == frozenset()
    assert conflicting_demands(MODEL, Demands(MODEL, Budget()), Budget(0)) == {}
