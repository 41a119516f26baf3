import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.errors import InvalidModelError, UnknownModeError, UnknownPartError
from domain.findings import Finding
from domain.lifecycle import LifecycleState
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import (
    EVERY_MODE,
    MAX_LEVELS,
    NodeModel,
    Rule,
    SmhModel,
    SystemModel,
)
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from domain.timebase import seconds
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    PERFORMANCE,
    STRONG,
    active,
    actuation_model,
    inactive,
    nested_model,
)

FAST = ModeName("FAST")


def node(name: str) -> NodeModel:
    return NodeModel(PartName(name), {DEFAULT_MODE: {"a": 1}, FAST: {"a": 2}})


def system(name: str, *parts: str, rules: tuple[Rule, ...] = ()) -> SystemModel:
    wanted = {PartName(part): active() for part in parts}
    return SystemModel(PartName(name), {DEFAULT_MODE: wanted}, rules)


def model(*parts: NodeModel | SystemModel) -> SmhModel:
    return SmhModel(
        {part.name: part for part in parts if isinstance(part, NodeModel)},
        {part.name: part for part in parts if isinstance(part, SystemModel)},
    )


def errors(*parts: NodeModel | SystemModel) -> list[Finding]:
    with pytest.raises(InvalidModelError) as caught:
        model(*parts)
    return list(caught.value.findings)


# --- a model that can be used ---


def test_a_model_knows_its_parts_and_their_modes() -> None:
    robot = actuation_model()

    assert robot.parts == (ACTUATION, BASE, ARM)
    assert BASE in robot
    assert "tail" not in robot
    assert robot.modes_of(ACTUATION) == ("__DEFAULT__", "MODERATE", "PERFORMANCE")
    assert robot.require_mode(ARM, "STRONG") == STRONG
    assert robot.systems[ACTUATION].modes[PERFORMANCE][ARM] == active("STRONG")


def test_what_a_model_does_not_have_is_named_with_what_it_has() -> None:
    robot = actuation_model()

    with pytest.raises(UnknownPartError, match="tail") as part:
        robot.modes_of(PartName("tail"))
    with pytest.raises(UnknownModeError, match="TURBO") as mode:
        robot.require_mode(ARM, "TURBO")
    with pytest.raises(UnknownModeError) as bare:
        model(NodeModel(PartName("n"))).require_mode(PartName("n"), "TURBO")

    assert part.value.hint == "known: actuation, drive_base, manipulator"
    assert mode.value.hint == "known: __DEFAULT__, WEAK, STRONG"
    assert bare.value.hint == "n has no modes, only a lifecycle state"


def test_ancestors_come_bottom_up_and_each_once() -> None:
    robot = nested_model()

    assert robot.ancestors[ARM] == (ACTUATION, "robot")
    assert robot.ancestors[PartName("robot")] == ()
    assert robot.nodes_below(PartName("robot")) == (ARM, BASE, "lidar")


def test_a_part_may_belong_to_several_systems() -> None:
    robot = model(
        system("root", "one", "two"), system("one", "n"), system("two", "n", "one"), node("n")
    )

    assert robot.ancestors[PartName("n")] == ("one", "two", "root")
    assert robot.nodes_below(PartName("root")) == ("n",)


def test_a_system_may_consist_of_nothing() -> None:
    wanted = {DEFAULT_MODE: {PartName("s"): StateAndMode(LifecycleState.ACTIVE)}}
    robot = model(SystemModel(PartName("s"), {}), SystemModel(PartName("root"), wanted))

    assert robot.systems[PartName("s")].parts == ()
    assert robot.nodes_below(PartName("root")) == ()
    assert robot.ancestors[PartName("s")] == ("root",)


def test_a_part_that_only_some_mode_names_has_that_system_as_ancestor() -> None:
    modes = {DEFAULT_MODE: {PartName("a"): active()}, FAST: {PartName("b"): inactive()}}
    robot = model(SystemModel(PartName("s"), modes), node("a"), node("b"))

    assert robot.systems[PartName("s")].parts == ("a",)
    assert robot.systems[PartName("s")].named_parts == ("a", "b")
    assert robot.ancestors[PartName("b")] == ("s",)


def test_a_model_cannot_be_changed() -> None:
    with pytest.raises(TypeError):
        actuation_model().nodes[PartName("tail")] = node("tail")  # type: ignore[index]


# --- what makes a model unusable ---


def test_a_part_that_there_is_not_is_told_once_and_not_for_each_mode_that_takes_it_over() -> None:
    ghost = {PartName("ghost"): active()}
    (finding,) = errors(SystemModel(PartName("s"), {DEFAULT_MODE: ghost, FAST: dict(ghost)}))

    assert (finding.code, finding.part) == ("UNKNOWN_PART", "s")
    assert finding.path == ("s", "modes", "__DEFAULT__", "ghost")


def test_a_mode_that_a_part_does_not_have_is_told_with_those_that_it_has() -> None:
    wanted = {PartName("n"): active("TURBO"), PartName("bare"): active("FAST")}
    turbo, fast = errors(
        SystemModel(PartName("s"), {DEFAULT_MODE: wanted}), node("n"), NodeModel(PartName("bare"))
    )

    assert turbo.message == "s in __DEFAULT__: n has no mode 'TURBO'; it has __DEFAULT__, FAST"
    assert fast.message == "s in __DEFAULT__: bare has no mode 'FAST'; it has no modes"


def test_modes_need_a_default() -> None:
    findings = errors(
        NodeModel(PartName("n"), {FAST: {"a": 1}}), SystemModel(PartName("s"), {FAST: {}})
    )

    assert {(f.code, f.path) for f in findings} == {
        ("MISSING_DEFAULT_MODE", ("n", "modes")),
        ("MISSING_DEFAULT_MODE", ("s", "modes")),
    }


def test_rules_can_speak_only_of_parts_and_modes_that_there_are() -> None:
    rule = Rule("r", active("SPEEDY"), (PartName("tail"), inactive()), active("SAFE"))
    findings = errors(system("s", "n", rules=(rule,)), node("n"))

    assert [(f.code, f.path) for f in findings] == [
        ("UNKNOWN_MODE", ("s", "rules", "r", "if_target")),
        ("UNKNOWN_PART", ("s", "rules", "r", "if_part")),
        ("UNKNOWN_MODE", ("s", "rules", "r", "new_target")),
    ]


def test_a_system_cannot_contain_itself() -> None:
    (finding,) = errors(system("s", "s"))

    assert finding.code == "CYCLE"
    assert finding.message == "s contains itself: s > s"


def test_systems_cannot_contain_each_other_through_any_mode() -> None:
    sneaky = {DEFAULT_MODE: {PartName("n"): active()}, FAST: {PartName("a"): inactive()}}
    (finding,) = errors(system("a", "b"), SystemModel(PartName("b"), sneaky), node("n"))

    assert finding.message == "a contains itself: a > b > a"
    assert finding.path == ("b", "modes", "FAST", "a")


def test_a_circle_of_thousands_is_told_in_a_sentence() -> None:
    (finding,) = errors(*(system(f"s{i}", f"s{(i + 1) % 5_000}") for i in range(5_000)))

    assert finding.code == "CYCLE"
    assert len(finding.message) < 150


def test_systems_may_be_nested_deeply_but_not_endlessly() -> None:
    levels = [system(f"s{i}", f"s{i + 1}") for i in range(MAX_LEVELS)]

    assert len(model(*levels, node(f"s{MAX_LEVELS}")).ancestors[PartName(f"s{MAX_LEVELS}")]) == 64
    deeper = system(f"s{MAX_LEVELS}", "n")
    assert [f.code for f in errors(*levels, deeper, node("n"))] == ["TOO_DEEP"]


def test_many_paths_to_one_node_are_walked_once() -> None:
    # Two systems a level, each in both of the level above: 2 ** 60 paths lead from top to bottom.
    levels = [
        system(f"{side}{level}", f"a{level + 1}", f"b{level + 1}")
        for level in range(60)
        for side in "ab"
    ]
    robot = model(*levels, node("a60"), node("b60"))

    assert robot.nodes_below(PartName("a0")) == ("a60", "b60")
    assert len(robot.ancestors[PartName("a60")]) == 120


def test_a_thicket_in_which_everything_contains_everything_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("domain.parts.system_model.MAX_ANCESTORS", 5)

    (finding,) = errors(system("a", "b", "n"), system("b", "c", "n"), system("c", "n"), node("n"))

    assert finding.code == "TOO_LARGE"


@given(
    st.dictionaries(st.sampled_from("abcdefg"), st.sets(st.sampled_from("abcdefgn")), max_size=7)
)
def test_a_model_has_no_errors_exactly_if_nothing_reaches_itself(
    parts_of: dict[str, set[str]],
) -> None:
    systems = {s: {p for p in parts if p in parts_of or p == "n"} for s, parts in parts_of.items()}
    reached = {s: set(parts) for s, parts in systems.items()}
    for _ in systems:
        for s in systems:
            reached[s] |= {below for part in reached[s] for below in reached.get(part, ())}
    parts: list[NodeModel | SystemModel] = [
        *(system(s, *sorted(below)) for s, below in systems.items()),
        node("n"),
    ]

    if any(s in below for s, below in reached.items()):
        assert {finding.code for finding in errors(*parts)} == {"CYCLE"}
    else:
        robot = model(*parts)
        for part in (*systems, "n"):
            above = robot.ancestors[PartName(part)]
            assert set(above) == {s for s, below in reached.items() if part in below}
            for position, ancestor in enumerate(above):
                assert not reached[ancestor] & set(above[position + 1 :])


# --- words ---


def test_what_is_told_of_a_missing_default_names_the_part() -> None:
    (finding,) = errors(NodeModel(PartName("n"), {FAST: {"a": 1}}))

    assert finding == Finding(
        "error", "MISSING_DEFAULT_MODE", "n has modes, but no __DEFAULT__", "n", ("n", "modes")
    )


def test_what_is_told_of_a_cycle_leads_to_the_line_that_closes_it() -> None:
    (finding,) = errors(system("a", "b"), system("b", "a"))

    assert finding == Finding(
        "error", "CYCLE", "a contains itself: a > b > a", "b", ("b", "modes", "__DEFAULT__", "a")
    )


def test_what_is_told_of_a_rule_says_where_in_it() -> None:
    rule = Rule("r", active("SPEEDY"), (PartName("tail"), inactive()), active())
    target, part = errors(system("s", "n", rules=(rule,)), node("n"))

    assert (target.severity, target.part) == ("error", "s")
    assert target.message == "rule r of s, if_target: s has no mode 'SPEEDY'; it has __DEFAULT__"
    assert (part.severity, part.part) == ("error", "s")
    assert part.message == "rule r of s, if_part: there is no part 'tail'"


@pytest.mark.parametrize(
    ("length", "names"),
    [
        (11, [*(f"s{i}" for i in range(11)), "s0"]),
        (12, [*(f"s{i}" for i in range(10)), "...", "s11", "s0"]),
        (50, [*(f"s{i}" for i in range(10)), "...", "s49", "s0"]),
    ],
)
def test_a_long_cycle_is_told_with_its_begin_and_its_end(length: int, names: list[str]) -> None:
    (finding,) = errors(*(system(f"s{i}", f"s{(i + 1) % length}") for i in range(length)))

    assert finding.message == f"s0 contains itself: {' > '.join(names)}"


def test_what_is_not_there_is_told_by_what_it_would_be() -> None:
    robot = actuation_model()
    with pytest.raises(UnknownPartError) as part:
        robot.modes_of(PartName("tail"))
    with pytest.raises(UnknownModeError) as mode:
        robot.require_mode(ARM, "TURBO")

    assert part.value.message == "there is no part 'tail'"
    assert mode.value.message == "there is no mode of manipulator 'TURBO'"


def test_a_mode_has_its_own_settings_else_those_of_every_mode_else_the_defaults() -> None:
    own, every = ModeSettings(fallback=DEFAULT_MODE), ModeSettings(grace=seconds(1))
    parts = {PartName("base"): node("base"), PartName("arm"): node("arm")}
    settings = {PartName("base"): {FAST: own, EVERY_MODE: every}}

    robot = SmhModel(parts, {}, settings)

    assert robot.settings_of(PartName("base"), FAST) is own
    assert robot.settings_of(PartName("base"), DEFAULT_MODE) is every
    assert robot.settings_of(PartName("base"), None) is every
    assert robot.settings_of(PartName("arm"), FAST) == ModeSettings()


def test_settings_that_lead_back_to_themselves_make_no_model() -> None:
    parts = {PartName("base"): node("base")}
    settings = {PartName("base"): {DEFAULT_MODE: ModeSettings(fallback=DEFAULT_MODE)}}

    with pytest.raises(InvalidModelError) as caught:
        SmhModel(parts, {}, settings)

    assert [finding.code for finding in caught.value.findings] == ["FALLBACK_CIRCLE"]


def test_a_path_leads_down_through_the_systems_in_between() -> None:
    robot, lidar = PartName("robot"), PartName("lidar")
    assert nested_model().path_down(robot, ARM) == (robot, ACTUATION, ARM)
    assert nested_model().path_down(robot, lidar) == (robot, lidar)
    assert nested_model().path_down(ARM, ARM) == (ARM,)
