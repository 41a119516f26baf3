"""What parts are in, inferred from what nodes report and what was asked."""

from random import Random

import hypothesis.strategies as st
import pytest
from hypothesis import Phase, find, given, settings

from domain.errors import UnknownPartError
from domain.findings import Blocker
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parameters import Parameters
from domain.parts.mode_inference import ModeInference
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.snapshot import Actual
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from tests.support.models import ACTUATION, ARM, BASE, active, actuation_model, nested_model
from tests.support.random_models import Happening, SetTarget, histories, models
from tests.support.tables import text_table

S = LifecycleState
LIDAR, ROBOT = PartName("lidar"), PartName("robot")
PARAMETERS: dict[str, Parameters] = {
    "drive_base.__DEFAULT__": {"max_speed": 0.1, "controller": "PID"},
    "drive_base.SLOW": {"max_speed": 0.2, "controller": "PID"},
    "drive_base.FAST": {"max_speed": 0.9, "controller": "MPC"},
    "manipulator.__DEFAULT__": {"max_torque": 0.1},
    "manipulator.WEAK": {"max_torque": 0.15},
    "manipulator.STRONG": {"max_torque": 0.2},
    "lidar.__DEFAULT__": {"rate": 5},
    "lidar.WIDE": {"rate": 20},
}


def _report(inference: ModeInference, node: PartName, label: str) -> set[PartName]:
    """Let a node report `inactive`, or `active.FAST` by its parameters."""
    wanted = StateAndMode.parse(label)
    parameters = PARAMETERS.get(f"{node}.{wanted.mode}")
    return inference.report(NodeReport(node, state=wanted.state, parameters=parameters))


def _inference(model: SmhModel | None = None, /, **nodes: str) -> ModeInference:
    inference = ModeInference(model or actuation_model())
    for node, label in nodes.items():
        _report(inference, PartName(node), label)
    return inference


def _label(inference: ModeInference, part: PartName = ACTUATION) -> str:
    return inference.actual(part).state_and_mode.label


# --- nodes ---------------------------------------------------------------------------------------


def test_a_node_that_never_reported_is_unknown_and_says_why() -> None:
    actual = _inference().actual(BASE)
    assert actual == Actual(S.UNKNOWN, reason="drive_base has never reported a state")


def test_a_node_that_cannot_be_reached_is_unknown_and_says_why() -> None:
    inference = _inference(drive_base="active.FAST")
    inference.report(NodeReport(BASE, reachable=False))
    assert inference.actual(BASE) == Actual(S.UNKNOWN, reason="drive_base is unreachable")


@pytest.mark.parametrize("state", [s for s in S if s not in (S.ACTIVE, S.UNKNOWN)])
def test_a_node_that_is_not_active_has_no_mode_whatever_its_parameters(
    state: LifecycleState,
) -> None:
    inference = _inference()
    inference.report(NodeReport(BASE, state, parameters=PARAMETERS["drive_base.FAST"]))
    assert inference.actual(BASE) == Actual(state)


def test_a_node_is_never_active_by_its_parameters() -> None:
    """Different from system_modes: `mode_change_on_unconfigured_nodes`, issue #99."""
    inference = _inference()
    inference.report(NodeReport(BASE, parameters=PARAMETERS["drive_base.FAST"]))
    assert inference.actual(BASE).state is S.UNKNOWN


def test_a_mode_that_parameters_match_is_inferred() -> None:
    inference = _inference(drive_base="active.FAST")
    assert inference.actual(BASE) == Actual(S.ACTIVE, ModeName("FAST"), mode_inferred=True)


def test_a_reported_mode_outranks_the_parameters() -> None:
    inference = _inference(drive_base="active.FAST")
    inference.report(NodeReport(BASE, mode=ModeName("SLOW")))
    assert inference.actual(BASE) == Actual(S.ACTIVE, ModeName("SLOW"))


def test_an_active_node_whose_parameters_match_nothing_says_so() -> None:
    inference = _inference(drive_base="active.FAST")
    inference.report(NodeReport(BASE, parameters={"max_speed": 7.7}))
    reason = "the parameters of drive_base match no mode"
    assert inference.actual(BASE) == Actual(S.ACTIVE, reason=reason)


def test_a_node_without_modes_has_none_and_needs_no_reason() -> None:
    pump = PartName("pump")
    inference = ModeInference(SmhModel({pump: NodeModel(pump)}, {}))
    inference.report(NodeReport(pump, state=S.ACTIVE))
    assert inference.actual(pump) == Actual(S.ACTIVE)


@pytest.mark.parametrize(
    ("known", "mode"),
    [
        ({"p": 1, "q": "x"}, "M"),
        ({"p": 1, "q": "x", "extra": 0}, "M"),
        ({"p": 1}, None),
        ({"p": 1.0, "q": "x"}, None),
        ({"p": True, "q": "x"}, None),
        ({"p": 1, "q": "y"}, None),
    ],
    ids=str,
)
def test_all_parameters_of_a_mode_must_be_there_with_type_and_value(
    known: Parameters, mode: str | None
) -> None:
    """system_modes, `params_match`: 1 and 1.0 are different."""
    node = PartName("n")
    modes: dict[ModeName, Parameters] = {
        DEFAULT_MODE: {"p": 0, "q": ""},
        ModeName("M"): {"p": 1, "q": "x"},
    }
    inference = ModeInference(SmhModel({node: NodeModel(node, modes)}, {}))
    inference.report(NodeReport(node, state=S.ACTIVE, parameters=known))
    assert inference.actual(node).mode == mode


def test_a_mode_with_lists_is_recognised_when_it_was_asked_for_and_not_guessed() -> None:
    """system_modes, `params_match`, never finds lists equal; what was asked for must be found."""
    node = PartName("n")
    inference = ModeInference(SmhModel({node: NodeModel(node, {DEFAULT_MODE: {"p": (1,)}})}, {}))
    inference.report(NodeReport(node, state=S.ACTIVE, parameters={"p": (1,)}))
    assert inference.actual(node).mode is None
    inference.set_targets({node: active()})
    assert inference.actual(node).mode == DEFAULT_MODE
    inference.report(NodeReport(node, parameters={"p": (1.0,)}))
    assert inference.actual(node).mode is None


@text_table("""
    # Target first, then `__DEFAULT__`, then byte order: 'A' < 'Z' < '_' < 'a'.
    matching        | asked for      | preferred
    a Z __DEFAULT__ | active.a       | a
    a Z __DEFAULT__ | -              | __DEFAULT__
    a Z __DEFAULT__ | active.NO_SUCH | __DEFAULT__
    a Z __DEFAULT__ | inactive       | __DEFAULT__
    a _B Z          | -              | Z
    a _B            | -              | _B
    a _B            | active.a       | a
""")
def test_of_several_modes_that_match_one_is_preferred(
    matching: str, asked_for: str, preferred: str
) -> None:
    node = PartName("n")
    modes = [ModeName(mode) for mode in ("a", "_B", "Z", DEFAULT_MODE)]
    values = {mode: {"p": 1 if mode in matching.split() else 0} for mode in modes}
    inference = ModeInference(SmhModel({node: NodeModel(node, values)}, {}))
    inference.report(NodeReport(node, state=S.ACTIVE, parameters={"p": 1}))
    inference.set_targets({node: None if asked_for == "-" else StateAndMode.parse(asked_for)})
    assert inference.actual(node).mode == preferred


# --- systems -------------------------------------------------------------------------------------


def _system(asked_for: str, drive_base: str, manipulator: str) -> ModeInference:
    """Return the example system: its target, and what its nodes report; `-` is nothing."""
    nodes = {"drive_base": drive_base, "manipulator": manipulator}
    inference = _inference(**{node: label for node, label in nodes.items() if label != "-"})
    target = None if asked_for == "-" else StateAndMode.parse(asked_for)
    inference.set_targets({ACTUATION: target})
    return inference


@text_table("""
    asked for | drive_base         | manipulator     | inferred

    # Nothing asked: the common state, and never a mode.
    -         | inactive           | inactive        | inactive
    -         | configuring        | configuring     | configuring
    -         | active.FAST        | active.STRONG   | active
    -         | active.FAST        | inactive        | unknown
    -         | errorprocessing    | inactive        | errorprocessing
    -         | inactive           | -               | unknown

    # Inactive: unconfigured parts count as inactive.
    inactive  | inactive           | inactive        | inactive
    inactive  | unconfigured       | inactive        | inactive
    inactive  | unconfigured       | unconfigured    | inactive
    inactive  | active.FAST        | inactive        | deactivating
    inactive  | configuring        | inactive        | deactivating
    inactive  | finalized          | inactive        | deactivating
    inactive  | errorprocessing    | inactive        | errorprocessing
    inactive  | inactive           | -               | unknown

    # The first part in byte order that tells decides; drive_base is before manipulator.
    inactive  | active.FAST        | -               | deactivating
    inactive  | active.FAST        | errorprocessing | deactivating
    inactive  | errorprocessing    | -               | errorprocessing

    # Unconfigured and finalized: when all parts are there.
    unconfigured | unconfigured    | unconfigured    | unconfigured
    unconfigured | unconfigured    | inactive        | cleaningup
    unconfigured | inactive        | inactive        | cleaningup
    unconfigured | unconfigured    | errorprocessing | errorprocessing
    unconfigured | inactive        | -               | unknown
    finalized    | finalized       | finalized       | finalized
    finalized    | finalized       | inactive        | shuttingdown

    # Active: when all parts are as the target mode wants, exactly.
    active.PERFORMANCE | active.FAST | active.STRONG   | active.PERFORMANCE
    active.PERFORMANCE | active.FAST | active.WEAK     | activating
    active.PERFORMANCE | active.FAST | inactive        | activating
    active.PERFORMANCE | active.FAST | -               | unknown
    active.PERFORMANCE | active.FAST | errorprocessing | errorprocessing

    # Until then the mode that the parts happen to match: D4.8, Annex 4, step 4.
    active.PERFORMANCE | active.SLOW        | active.WEAK  | activating.MODERATE
    active.PERFORMANCE | active.__DEFAULT__ | inactive     | activating.__DEFAULT__

    # A part that shall be inactive may be unconfigured, but only for the target mode.
    active.__DEFAULT__ | active.__DEFAULT__ | inactive     | active.__DEFAULT__
    active.__DEFAULT__ | active.__DEFAULT__ | unconfigured | active.__DEFAULT__
    active.__DEFAULT__ | active.__DEFAULT__ | finalized    | activating
    active.PERFORMANCE | active.__DEFAULT__ | unconfigured | activating

    # What was asked without a mode, or with one that is not there, is never reached.
    active         | active.__DEFAULT__ | inactive        | activating.__DEFAULT__
    active.NO_SUCH | active.FAST        | active.STRONG   | activating.PERFORMANCE
    active.NO_SUCH | active.FAST        | errorprocessing | errorprocessing

    # No state that can be asked for.
    configuring    | inactive           | inactive        | unknown
    unknown        | inactive           | inactive        | unknown
""")
def test_what_a_system_is_in(
    asked_for: str, drive_base: str, manipulator: str, inferred: str
) -> None:
    """docs/explanation/inference.md; system_modes, `mode_inference.cpp`."""
    inference = _system(asked_for, drive_base, manipulator)
    assert _label(inference) == inferred
    assert inference.actual(ACTUATION).inferred
    assert inference.actual(ACTUATION).undecidable is (inferred == "unknown")


@text_table("""
    asked for   | drive_base  | manipulator | reason
    -           | inactive    | -           | manipulator has never reported a state
    active.__DEFAULT__ | -    | inactive    | drive_base has never reported a state
    configuring | inactive    | inactive    | configuring cannot be the target of a system
    -           | active.FAST | inactive    | there is no target, \
and drive_base is active while manipulator is inactive
""")
def test_what_cannot_be_decided_says_why(
    asked_for: str, drive_base: str, manipulator: str, reason: str
) -> None:
    assert _system(asked_for, drive_base, manipulator).actual(ACTUATION).reason == reason


def test_whether_the_mode_of_a_system_was_inferred_is_told() -> None:
    inference = _inference(drive_base="active.FAST", manipulator="active.STRONG")
    assert not inference.actual(ACTUATION).mode_inferred
    inference.set_targets({ACTUATION: active("PERFORMANCE")})
    assert inference.actual(ACTUATION).mode_inferred


def test_a_mode_that_wants_fewer_parts_than_it_names_is_reached_only_with_all_it_names() -> None:
    """The target mode is judged by its own parts, others by those of `__DEFAULT__`."""
    extra = ModeName("EXTRA")
    model = actuation_model()
    modes = {DEFAULT_MODE: {BASE: active()}, extra: {BASE: active(), ARM: active("STRONG")}}
    inference = _inference(
        SmhModel(model.nodes, {ACTUATION: SystemModel(ACTUATION, modes)}),
        drive_base="active.__DEFAULT__",
        manipulator="active.WEAK",
    )
    inference.set_targets({ACTUATION: active("EXTRA")})
    assert _label(inference) == "activating.EXTRA"
    _report(inference, ARM, "active.STRONG")
    assert _label(inference) == "active.EXTRA"


# --- hierarchies ---------------------------------------------------------------------------------


def _nested(**nodes: str) -> ModeInference:
    inference = _inference(nested_model(), **nodes)
    inference.set_targets({ROBOT: active("RACE"), ACTUATION: active("PERFORMANCE")})
    return inference


RACING = {"drive_base": "active.FAST", "manipulator": "active.STRONG", "lidar": "active.WIDE"}


def test_a_system_of_systems_is_active_when_all_below_are_there() -> None:
    assert _label(_nested(**RACING), ROBOT) == "active.RACE"


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"manipulator": "active.WEAK"}, "activating"),
        ({"manipulator": "errorprocessing"}, "errorprocessing"),
        ({"lidar": "active.__DEFAULT__"}, "activating"),
    ],
)
def test_what_is_wrong_below_is_seen_at_the_top(change: dict[str, str], expected: str) -> None:
    assert _label(_nested(**{**RACING, **change}), ROBOT) == expected


def test_what_is_not_known_below_is_named_at_the_top() -> None:
    inference = _nested(**RACING)
    inference.report(NodeReport(ARM, reachable=False))
    assert inference.actual(ROBOT).reason == "manipulator is unreachable"


def test_a_system_without_a_target_has_no_mode_that_its_parent_could_match() -> None:
    """system_modes.md 3.5."""
    inference = _nested(**RACING)
    inference.set_targets({ACTUATION: None})
    assert _label(inference, ROBOT) == "activating"


def test_parents_do_not_see_the_mode_of_a_system_that_is_activating() -> None:
    inference = _nested(**RACING)
    _report(inference, BASE, "active.SLOW")
    _report(inference, ARM, "active.WEAK")
    assert inference.actual(ACTUATION).mode == "MODERATE"
    assert inference.as_seen(ACTUATION) == StateAndMode(S.ACTIVATING)


@pytest.mark.parametrize(
    ("label", "seen"), [("active.FAST", active("FAST")), ("inactive", StateAndMode(S.INACTIVE))]
)
def test_parents_see_the_mode_of_an_active_part(label: str, seen: StateAndMode) -> None:
    assert _inference(drive_base=label).as_seen(BASE) == seen


def test_parents_see_nothing_of_what_cannot_be_decided() -> None:
    assert _inference().as_seen(ACTUATION) is None


# --- targets and deviations ----------------------------------------------------------------------


def test_a_part_that_nothing_was_asked_of_is_where_it_should_be() -> None:
    assert _inference(drive_base="inactive").converged(BASE)


def test_a_part_is_where_it_should_be_when_state_and_mode_agree() -> None:
    inference = _inference(drive_base="active.SLOW")
    inference.set_targets({BASE: active("FAST")})
    assert not inference.converged(BASE)
    _report(inference, BASE, "active.FAST")
    assert inference.converged(BASE)


def test_an_unknown_part_is_not_where_it_should_be_and_no_decidable_deviation() -> None:
    inference = _inference()
    inference.set_targets({BASE: active()})
    assert not inference.converged(BASE)
    assert inference.deviations() == []


def test_deviations_are_told_by_byte_order_with_what_is_and_what_should_be() -> None:
    inference = _inference(drive_base="inactive", manipulator="active.WEAK")
    targets = {part: active("STRONG") for part in (ARM, BASE)}
    inference.set_targets(targets)
    assert inference.deviations() == [
        (BASE, active("STRONG"), StateAndMode(S.INACTIVE)),
        (ARM, active("STRONG"), active("WEAK")),
    ]


def test_a_target_that_is_taken_away_is_gone() -> None:
    inference = _inference()
    inference.set_targets({BASE: active()})
    inference.set_targets({BASE: None})
    assert inference.target(BASE) is None


# --- what is not in the model --------------------------------------------------------------------


@pytest.mark.parametrize("part", [PartName("gripper"), ACTUATION])
def test_only_nodes_report(part: PartName) -> None:
    with pytest.raises(UnknownPartError):
        _inference().report(NodeReport(part, state=S.ACTIVE))


def test_a_target_of_an_unknown_part_records_no_other_target_either() -> None:
    inference = _inference()
    with pytest.raises(UnknownPartError):
        inference.set_targets({BASE: active(), PartName("gripper"): active()})
    assert inference.target(BASE) is None


# --- touched parts -------------------------------------------------------------------------------


def test_a_report_tells_which_parts_are_something_else_now() -> None:
    inference = _nested(**RACING)
    assert _report(inference, ARM, "active.WEAK") == {ARM, ACTUATION, ROBOT}
    assert _report(inference, ARM, "active.WEAK") == set()


def test_a_target_tells_which_parts_are_something_else_now() -> None:
    inference = _inference(drive_base="active.FAST", manipulator="active.STRONG")
    assert inference.set_targets({ACTUATION: active("PERFORMANCE")}) == {ACTUATION}


# --- any model, any history ----------------------------------------------------------------------


def _apply(inference: ModeInference, happening: Happening) -> set[PartName]:
    if isinstance(happening, SetTarget):
        return inference.set_targets({happening.part: happening.target})
    return inference.report(happening)


def _from_scratch(inference: ModeInference) -> ModeInference:
    """Return another inference that is told all facts and targets at once."""
    fresh = ModeInference(inference.model)
    fresh.set_targets({part: inference.target(part) for part in inference.model.parts})
    for node, facts in inference.facts.items():
        if facts.reachable is not None:
            fresh.report(
                NodeReport(
                    node,
                    facts.state,
                    facts.mode,
                    facts.parameters,
                    facts.reachable,
                    facts.has_lifecycle,
                )
            )
    return fresh


@given(st.data())
def test_the_order_of_reports_never_matters_only_what_is_known(data: st.DataObject) -> None:
    model = data.draw(models())
    inference = ModeInference(model)
    for happening in data.draw(histories(model)):
        before = {part: _inferred(inference, part) for part in model.parts}
        changed = _apply(inference, happening)
        after = {part: _inferred(inference, part) for part in model.parts}
        assert changed >= {part for part in model.parts if before[part] != after[part]}
    fresh = _from_scratch(inference)
    assert {p: _inferred(inference, p) for p in model.parts} == {
        p: _inferred(fresh, p) for p in model.parts
    }


def _inferred(inference: ModeInference, part: PartName) -> tuple[object, ...]:
    """Return all that is inferred of a part."""
    return (
        inference.actual(part),
        inference.converged(part),
        inference.deviation_reason(part),
    )


def _as_wanted(actual: Actual, want: StateAndMode) -> bool:
    if want.state is S.INACTIVE:
        return actual.state in (S.INACTIVE, S.UNCONFIGURED)
    return actual.state_and_mode == want


@given(st.data())
def test_an_active_system_has_every_part_as_its_mode_wants_it(data: st.DataObject) -> None:
    model = data.draw(models())
    inference = ModeInference(model)
    for happening in data.draw(histories(model)):
        _apply(inference, happening)
        for name, system in model.systems.items():
            actual = inference.actual(name)
            if actual.state is S.ACTIVE and actual.mode is not None:
                assert actual.state_and_mode == inference.target(name)
                for part, want in system.modes[actual.mode].items():
                    assert _as_wanted(inference.actual(part), want), part


@given(st.data())
def test_what_is_unknown_has_a_reason_and_what_is_decided_has_a_state(
    data: st.DataObject,
) -> None:
    model = data.draw(models())
    inference = ModeInference(model)
    for happening in data.draw(histories(model)):
        _apply(inference, happening)
    for part in model.parts:
        actual = inference.actual(part)
        assert actual.undecidable is (actual.state is S.UNKNOWN and part in model.systems)
        assert bool(actual.reason) or actual.state is not S.UNKNOWN
        assert actual.mode is None or actual.state in (S.ACTIVE, S.ACTIVATING)


def test_random_histories_reach_systems_of_systems_that_are_active() -> None:
    """Otherwise the properties above would say little."""

    def reached(drawn: tuple[SmhModel, list[Happening]]) -> bool:
        model, history = drawn
        inference = ModeInference(model)
        for happening in history:
            _apply(inference, happening)
        return any(
            inference.actual(name).mode is not None
            and inference.actual(name).state is S.ACTIVE
            and any(part in model.systems for part in system.parts)
            for name, system in model.systems.items()
        )

    with_history = models().flatmap(lambda m: st.tuples(st.just(m), histories(m)))
    find(with_history, reached, settings=settings(max_examples=500, phases=[Phase.generate]))


# --- words ---------------------------------------------------------------------------------------


def test_a_report_of_an_unknown_node_names_those_that_there_are() -> None:
    with pytest.raises(UnknownPartError) as unknown:
        _inference().report(NodeReport(PartName("tail"), state=S.ACTIVE))
    assert unknown.value.message == "there is no node 'tail'"
    assert unknown.value.hint == "known: drive_base, manipulator"


def test_a_target_of_an_unknown_part_names_those_that_there_are() -> None:
    with pytest.raises(UnknownPartError) as unknown:
        _inference().set_targets({PartName("tail"): active()})
    assert unknown.value.message == "there is no part 'tail'"
    assert unknown.value.hint == "known: actuation, drive_base, manipulator"


def test_a_mode_on_the_way_is_inferred_and_says_so() -> None:
    inference = _inference(drive_base="active.SLOW", manipulator="active.WEAK")
    inference.set_targets({ACTUATION: active("PERFORMANCE")})
    assert inference.actual(ACTUATION) == Actual(
        S.ACTIVATING, ModeName("MODERATE"), inferred=True, mode_inferred=True
    )


def test_a_system_of_nothing_that_nothing_was_asked_of_is_unknown_and_decided() -> None:
    empty = PartName("empty")
    inference = ModeInference(SmhModel({}, {empty: SystemModel(empty, {})}))
    assert inference.actual(empty) == Actual(S.UNKNOWN, inferred=True)


# --- plain nodes ---------------------------------------------------------------------------------


def _with_a_plain_base(arm: str, target: str | None) -> ModeInference:
    inference = _inference(manipulator=arm)
    _report(inference, BASE, "active.SLOW")
    inference.report(NodeReport(BASE, has_lifecycle=False))
    inference.set_targets({ACTUATION: StateAndMode.parse(target) if target else None})
    return inference


@text_table("""
    asked for       | manipulator  | inferred
    -               | unconfigured | unconfigured
    inactive        | inactive     | inactive
    inactive        | active.WEAK  | deactivating
    unconfigured    | unconfigured | unconfigured
    unconfigured    | inactive     | cleaningup
    finalized       | finalized    | finalized
    active.MODERATE | active.WEAK  | active.MODERATE
""")
def test_a_plain_node_does_not_keep_its_system_from_being_at_rest(
    asked_for: str, manipulator: str, inferred: str
) -> None:
    """docs/explanation/inference.md: it counts as active; system_modes issue #90."""
    target = None if asked_for == "-" else asked_for
    assert _label(_with_a_plain_base(manipulator, target)) == inferred


def test_a_system_of_plain_nodes_is_active_as_they_are() -> None:
    inference = _with_a_plain_base("active.WEAK", None)
    inference.report(NodeReport(ARM, has_lifecycle=False))

    assert _label(inference) == "active"


def test_a_plain_node_of_which_nothing_is_heard_leaves_its_system_unknown() -> None:
    inference = _with_a_plain_base("inactive", "inactive")
    inference.report(NodeReport(BASE, reachable=False))

    assert inference.actual(ACTUATION).reason == "drive_base is unreachable"


def test_a_node_that_turns_out_to_have_a_lifecycle_counts_again() -> None:
    inference = _with_a_plain_base("inactive", "inactive")
    inference.report(NodeReport(BASE, has_lifecycle=True))

    assert _label(inference) == "deactivating"


def test_modes_follow_every_target_and_report_as_if_all_had_been_told_at_once() -> None:
    """A node whose parameters match two modes at once, and one with a list."""
    node, lists = PartName("node"), PartName("lists")
    both: Parameters = {"speed": 1.0}
    modes = {DEFAULT_MODE: both, ModeName("TWIN"): both, ModeName("FAST"): {"speed": 2.0}}
    with_list: dict[ModeName, Parameters] = {
        DEFAULT_MODE: both,
        ModeName("LIST"): {"speed": 1.0, "gains": (1.0, 2.0)},
    }
    model = SmhModel({node: NodeModel(node, modes), lists: NodeModel(lists, with_list)}, {})
    drawn = Random(12)
    told = ModeInference(model)
    for _ in range(400):
        name = drawn.choice((node, lists))
        if drawn.random() < 0.4:
            mode = drawn.choice((*model.nodes[name].modes, None))
            told.set_targets({name: StateAndMode(LifecycleState.ACTIVE, mode)})
        else:
            values = {
                "speed": drawn.choice((1.0, 2.0)),
                "gains": drawn.choice(((1.0, 2.0), (3.0,))),
            }
            state = drawn.choice((LifecycleState.ACTIVE, LifecycleState.INACTIVE, None))
            told.report(NodeReport(name, state=state, parameters=drawn.choice((values, None))))
        anew = ModeInference(model)
        anew.set_targets({part: told.target(part) for part in model.nodes})
        for part, facts in told.facts.items():
            anew.report(NodeReport(part, state=facts.state, parameters=facts.parameters))
        assert [told.actual(part) for part in model.nodes] == [
            anew.actual(part) for part in model.nodes
        ]


# --- what was known last -------------------------------------------------------------------------


@pytest.mark.parametrize("label", ["inactive", "active.FAST"])
def test_of_a_node_that_is_unreachable_it_stays_known_where_it_was(label: str) -> None:
    inference = ModeInference(actuation_model())
    _report(inference, BASE, label)
    assert inference.last_known(BASE) is None

    inference.report(NodeReport(BASE, reachable=False))
    assert inference.actual(BASE).state is S.UNKNOWN
    assert inference.last_known(BASE) == StateAndMode.parse(label)

    inference.report(NodeReport(BASE, reachable=True))
    assert inference.last_known(BASE) is None


def test_a_mode_that_was_reported_outranks_parameters_also_in_memory() -> None:
    inference = ModeInference(actuation_model())
    _report(inference, BASE, "active.FAST")
    inference.report(NodeReport(BASE, mode=ModeName("SLOW")))
    inference.report(NodeReport(BASE, reachable=False))

    assert inference.last_known(BASE) == StateAndMode.parse("active.SLOW")


def test_of_a_node_that_was_never_heard_nothing_is_known() -> None:
    inference = ModeInference(actuation_model())
    assert inference.last_known(BASE) is None
    inference.report(NodeReport(BASE, reachable=False))
    assert inference.last_known(BASE) is None


LOST_DEVICE = Blocker("DEVICE_LOST", "device arm is not connected", ())


def test_why_nothing_is_heard_of_nodes_is_told_of_all_that_are_unknown_because_of_it() -> None:
    inference = _inference(drive_base="active.SLOW")
    inference.report(NodeReport(ARM, reachable=False))

    assert inference.note_cut_off((ARM,), LOST_DEVICE) == {ARM, ACTUATION}

    why = "manipulator is unreachable: device arm is not connected"
    assert inference.actual(ARM).reason == inference.actual(ACTUATION).reason == why
    assert inference.note_cut_off((ARM,), LOST_DEVICE) == set()

    assert inference.note_cut_off((ARM,), None) == {ARM, ACTUATION}
    assert inference.actual(ACTUATION).reason == "manipulator is unreachable"


def test_a_node_that_is_still_heard_is_what_it_is() -> None:
    inference = _inference(drive_base="active.SLOW", manipulator="inactive")

    assert inference.note_cut_off((ARM,), LOST_DEVICE) == set()

    assert _label(inference, ARM) == "inactive"
    inference.report(NodeReport(ARM, reachable=False))
    assert inference.actual(ARM).reason == (
        "manipulator is unreachable: device arm is not connected"
    )
