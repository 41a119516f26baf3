"""What a change asks of each part, and the steps that lead a node there."""

import hypothesis.strategies as st
import pytest
from hypothesis import given

from domain.changes.plan import Action, NodeGoal, SetParameters, goal_of, next_steps, presumed_steps
from domain.inputs import ChangeRequest, ModeRequest, ParametersRequest, TransitionRequest
from domain.lifecycle import LifecycleState, Transition, arrival, rule_for
from domain.parameters import Parameters
from domain.parts.node_facts import NodeFacts
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from tests.support.models import ACTUATION, ARM, BASE, actuation_model, nested_model

S, T = LifecycleState, Transition
LIDAR, ROBOT = PartName("lidar"), PartName("robot")
MODEL = actuation_model()
FAST: Parameters = {"max_speed": 0.9, "controller": "MPC"}
SLOW: Parameters = {"max_speed": 0.2, "controller": "PID"}
SET_FAST = SetParameters(FAST, ModeName("FAST"))


def _facts(
    state: LifecycleState | None = S.UNCONFIGURED,
    parameters: Parameters | None = None,
    mode: str | None = None,
    *,
    has_lifecycle: bool = True,
) -> NodeFacts:
    reported = ModeName(mode) if mode else None
    return NodeFacts(state, reported, dict(parameters or {}), True, has_lifecycle)


def _targets(
    request: ChangeRequest, model: SmhModel = MODEL, **states: LifecycleState
) -> dict[str, str]:
    facts = {node: _facts(states.get(node, S.INACTIVE)) for node in model.nodes}
    goal = goal_of(model, request, facts)
    return {part: target.label for part, target in goal.targets.items()}


# --- targets -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("request_", "targets"),
    [
        (
            ModeRequest(ACTUATION, "PERFORMANCE"),
            {
                "actuation": "active.PERFORMANCE",
                "manipulator": "active.STRONG",
                "drive_base": "active.FAST",
            },
        ),
        (
            ModeRequest(ACTUATION, "__DEFAULT__"),
            {
                "actuation": "active.__DEFAULT__",
                "manipulator": "inactive",
                "drive_base": "active.__DEFAULT__",
            },
        ),
        (ModeRequest(BASE, "SLOW"), {"drive_base": "active.SLOW"}),
        (TransitionRequest(BASE, T.CONFIGURE), {"drive_base": "inactive"}),
        (TransitionRequest(BASE, T.ACTIVATE), {"drive_base": "active.__DEFAULT__"}),
        (TransitionRequest(BASE, T.SHUTDOWN), {"drive_base": "finalized"}),
        (
            TransitionRequest(ACTUATION, T.CLEANUP),
            {
                "actuation": "unconfigured",
                "manipulator": "unconfigured",
                "drive_base": "unconfigured",
            },
        ),
        (ParametersRequest(BASE, {"max_speed": 0.4}), {}),
    ],
    ids=str,
)
def test_the_target_of_a_part_sets_the_targets_of_all_parts_below(
    request_: ChangeRequest, targets: dict[str, str]
) -> None:
    """docs/explanation/semantics.md: a system's target sets its parts' targets."""
    assert _targets(request_) == targets


def test_activating_without_a_mode_means_default() -> None:
    activate = _targets(TransitionRequest(ACTUATION, T.ACTIVATE))
    assert activate == _targets(ModeRequest(ACTUATION, "__DEFAULT__"))


def test_a_part_without_modes_is_activated_without_one() -> None:
    pump = PartName("pump")
    model = SmhModel({pump: NodeModel(pump)}, {})
    goal = goal_of(model, TransitionRequest(pump, T.ACTIVATE), {pump: _facts()})
    assert goal.targets == {pump: StateAndMode(S.ACTIVE)}
    assert goal.nodes == {pump: NodeGoal(S.ACTIVE)}


def test_a_mode_of_a_nested_system_reaches_the_nodes_of_the_inner_one() -> None:
    assert _targets(ModeRequest(ROBOT, "RACE"), nested_model()) == {
        "robot": "active.RACE",
        "actuation": "active.PERFORMANCE",
        "manipulator": "active.STRONG",
        "drive_base": "active.FAST",
        "lidar": "active.WIDE",
    }


def test_a_mode_that_wants_an_inner_system_inactive_wants_its_nodes_inactive() -> None:
    assert _targets(ModeRequest(ROBOT, "PARKED"), nested_model()) == {
        "robot": "active.PARKED",
        "actuation": "inactive",
        "manipulator": "inactive",
        "drive_base": "inactive",
        "lidar": "active.__DEFAULT__",
    }


@pytest.mark.parametrize(
    ("transition", "state", "kept"),
    [
        # Deactivating a system never configures a part of it.
        (T.DEACTIVATE, S.UNCONFIGURED, "unconfigured"),
        (T.DEACTIVATE, S.CLEANING_UP, "unconfigured"),
        (T.DEACTIVATE, S.ERROR_PROCESSING, "unconfigured"),
        (T.DEACTIVATE, S.FINALIZED, "finalized"),
        (T.DEACTIVATE, S.SHUTTING_DOWN, "finalized"),
        (T.CLEANUP, S.FINALIZED, "finalized"),
        (T.SHUTDOWN, S.FINALIZED, "finalized"),
        # These have to go.
        (T.DEACTIVATE, S.ACTIVE, "inactive"),
        (T.DEACTIVATE, S.CONFIGURING, "inactive"),
        (T.DEACTIVATE, S.UNKNOWN, "inactive"),
        (T.CLEANUP, S.UNCONFIGURED, "unconfigured"),
        (T.CLEANUP, S.ACTIVE, "unconfigured"),
        (T.SHUTDOWN, S.UNCONFIGURED, "finalized"),
        # Out of `finalized` there is no way: what wants one must say so, and not succeed.
        (T.ACTIVATE, S.FINALIZED, "active.__DEFAULT__"),
        (T.CONFIGURE, S.FINALIZED, "inactive"),
        (T.CONFIGURE, S.UNCONFIGURED, "inactive"),
    ],
)
def test_a_transition_of_a_system_passes_by_the_nodes_that_it_has_nothing_to_do_with(
    transition: Transition, state: LifecycleState, kept: str
) -> None:
    targets = _targets(TransitionRequest(ACTUATION, transition), drive_base=state)
    assert targets["drive_base"] == kept


def test_a_node_that_is_asked_itself_is_never_passed_by() -> None:
    targets = _targets(TransitionRequest(BASE, T.DEACTIVATE), drive_base=S.UNCONFIGURED)
    assert targets == {"drive_base": "inactive"}


def test_a_mode_passes_nothing_by() -> None:
    targets = _targets(ModeRequest(ACTUATION, "__DEFAULT__"), manipulator=S.FINALIZED)
    assert targets["manipulator"] == "inactive"


@pytest.mark.parametrize("transition", [T.CONFIGURE, T.DEACTIVATE, T.CLEANUP, T.SHUTDOWN])
def test_a_plain_node_has_the_target_of_its_system_and_nothing_is_asked_of_it(
    transition: Transition,
) -> None:
    """system_modes, launch test `two_mixed_nodes`."""
    facts = {ARM: _facts(S.INACTIVE), BASE: _facts(None, has_lifecycle=False)}
    goal = goal_of(MODEL, TransitionRequest(ACTUATION, transition), facts)
    assert goal.targets[BASE] == StateAndMode(transition.goal)
    assert goal.nodes.keys() == {ARM}


def test_a_plain_node_that_is_asked_itself_has_no_way() -> None:
    facts = {ARM: _facts(S.INACTIVE), BASE: _facts(None, has_lifecycle=False)}
    goal = goal_of(MODEL, TransitionRequest(BASE, T.DEACTIVATE), facts)
    assert next_steps(facts[BASE], goal.nodes[BASE]) is None


def test_a_mode_that_wants_a_plain_node_inactive_is_not_to_be_had() -> None:
    facts = {ARM: _facts(None, has_lifecycle=False), BASE: _facts(S.INACTIVE)}
    goal = goal_of(MODEL, ModeRequest(ACTUATION, "__DEFAULT__"), facts)
    assert next_steps(facts[ARM], goal.nodes[ARM]) is None


def test_a_plain_node_gets_the_parameters_of_its_mode_when_its_system_is_activated() -> None:
    facts = {ARM: _facts(S.INACTIVE), BASE: _facts(None, has_lifecycle=False)}
    goal = goal_of(MODEL, TransitionRequest(ACTUATION, T.ACTIVATE), facts)
    assert goal.nodes[BASE].parameters == {"max_speed": 0.1, "controller": "PID"}


# --- goals of nodes ------------------------------------------------------------------------------


def test_a_node_that_shall_be_active_shall_have_the_parameters_of_its_mode() -> None:
    facts = {node: _facts() for node in MODEL.nodes}
    goal = goal_of(MODEL, ModeRequest(ACTUATION, "PERFORMANCE"), facts)
    assert goal.nodes[BASE] == NodeGoal(S.ACTIVE, ModeName("FAST"), FAST)


def test_a_node_that_shall_be_inactive_keeps_its_parameters() -> None:
    facts = {node: _facts() for node in MODEL.nodes}
    goal = goal_of(MODEL, ModeRequest(ACTUATION, "__DEFAULT__"), facts)
    assert goal.nodes[ARM] == NodeGoal(S.INACTIVE)


def test_setting_parameters_asks_for_no_state() -> None:
    goal = goal_of(MODEL, ParametersRequest(BASE, {"max_speed": 0.4}), {})
    assert goal.nodes == {BASE: NodeGoal(None, None, {"max_speed": 0.4})}


# --- steps ---------------------------------------------------------------------------------------


GOAL_FAST = NodeGoal(S.ACTIVE, ModeName("FAST"), FAST)


@pytest.mark.parametrize(
    ("facts", "goal", "steps"),
    [
        # The whole way; parameters before the activation, so that it never runs in another mode.
        (_facts(S.UNCONFIGURED), GOAL_FAST, (T.CONFIGURE, SET_FAST, T.ACTIVATE)),
        (_facts(S.INACTIVE), GOAL_FAST, (SET_FAST, T.ACTIVATE)),
        # No needless step: system_modes issue #60.
        (_facts(S.INACTIVE, FAST), GOAL_FAST, (T.ACTIVATE,)),
        (_facts(S.ACTIVE, FAST), GOAL_FAST, ()),
        (_facts(S.ACTIVE, {**FAST, "max_speed": 0.2}), GOAL_FAST, (SET_FAST,)),
        (_facts(S.ACTIVE, {"max_speed": 0.9}), GOAL_FAST, (SET_FAST,)),
        # A node that says it is in another mode must be told, whatever its parameters.
        (_facts(S.ACTIVE, FAST, "SLOW"), GOAL_FAST, (SET_FAST,)),
        (_facts(S.ACTIVE, FAST, "FAST"), GOAL_FAST, ()),
        # Cleanup and shutdown deactivate first.
        (_facts(S.ACTIVE), NodeGoal(S.UNCONFIGURED), (T.DEACTIVATE, T.CLEANUP)),
        (_facts(S.ACTIVE), NodeGoal(S.FINALIZED), (T.DEACTIVATE, T.SHUTDOWN)),
        (_facts(S.UNCONFIGURED), NodeGoal(S.FINALIZED), (T.SHUTDOWN,)),
        (_facts(S.UNCONFIGURED), NodeGoal(S.INACTIVE), (T.CONFIGURE,)),
        (_facts(S.ACTIVE), NodeGoal(S.INACTIVE), (T.DEACTIVATE,)),
        # A node on its way is planned from where it will arrive.
        (_facts(S.CONFIGURING, FAST), GOAL_FAST, (T.ACTIVATE,)),
        (_facts(S.ERROR_PROCESSING, FAST), GOAL_FAST, (T.CONFIGURE, T.ACTIVATE)),
        # Out of `finalized` there is no way.
        (_facts(S.FINALIZED), NodeGoal(S.INACTIVE), None),
        (_facts(S.FINALIZED), NodeGoal(S.FINALIZED), ()),
        # Parameters alone are set in any state.
        (_facts(S.FINALIZED, SLOW), NodeGoal(None, None, FAST), (SetParameters(FAST),)),
        (_facts(S.INACTIVE, FAST), NodeGoal(None, None, FAST), ()),
        (
            _facts(S.INACTIVE, {"a": 1}),
            NodeGoal(None, None, {"a": 1.0}),
            (SetParameters({"a": 1.0}),),
        ),
        # A plain node is active, and nothing else.
        (_facts(None, has_lifecycle=False), GOAL_FAST, (SET_FAST,)),
        (_facts(None, FAST, has_lifecycle=False), GOAL_FAST, ()),
        (_facts(None, has_lifecycle=False), NodeGoal(S.INACTIVE), None),
    ],
)
def test_the_steps_to_a_goal(
    facts: NodeFacts, goal: NodeGoal, steps: tuple[Action, ...] | None
) -> None:
    assert next_steps(facts, goal) == steps


@given(
    start=st.sampled_from([s for s in S if s is not S.UNKNOWN]),
    end=st.sampled_from([S.UNCONFIGURED, S.INACTIVE, S.ACTIVE, S.FINALIZED]),
    known=st.sampled_from([{}, SLOW, FAST]),
)
def test_steps_that_are_done_lead_to_the_goal(
    start: LifecycleState, end: LifecycleState, known: Parameters
) -> None:
    goal = NodeGoal(end, None, FAST if end is S.ACTIVE else {})
    steps = next_steps(_facts(start, known), goal)
    state, parameters = arrival(start), dict(known)
    if steps is None:
        assert state is S.FINALIZED
        return
    for step in steps:
        if isinstance(step, SetParameters):
            parameters |= step.values
            continue
        rule = rule_for(state, step)
        assert rule is not None, "an illegal transition"
        state = rule.success
        if state is S.ACTIVE:
            assert parameters == FAST, "activated in another mode"
    assert state is end
    assert goal.parameters.items() <= parameters.items()


@pytest.mark.parametrize(
    ("goal", "steps"),
    [
        (NodeGoal(S.INACTIVE), (T.CONFIGURE,)),
        (NodeGoal(S.UNCONFIGURED), (T.CLEANUP,)),
        (GOAL_FAST, (T.ACTIVATE,)),
        (NodeGoal(S.FINALIZED), (T.SHUTDOWN,)),
        (NodeGoal(None, None, FAST), (SetParameters(FAST),)),
        (NodeGoal(S.CONFIGURING), ()),
    ],
    ids=str,
)
def test_of_an_unknown_node_the_last_step_is_presumed(
    goal: NodeGoal, steps: tuple[Action, ...]
) -> None:
    assert presumed_steps(goal) == steps


def test_a_system_without_modes_can_be_asked_for_a_transition_and_has_nothing_to_do() -> None:
    empty = PartName("empty")
    model = SmhModel({}, {empty: SystemModel(empty, {})})

    goal = goal_of(model, TransitionRequest(empty, Transition.ACTIVATE), {})

    assert (goal.targets, goal.nodes) == ({empty: StateAndMode(LifecycleState.ACTIVE)}, {})


def test_parts_that_are_shared_on_every_level_are_gone_through_once() -> None:
    """Two systems on each of 60 levels, each of both of the level below: 2 to the 60 ways down."""
    names = [[PartName(f"s{level}{side}") for side in "ab"] for level in range(60)]
    leaf = PartName("leaf")
    systems = {}
    for level, pair in enumerate(names):
        below = names[level + 1] if level + 1 < len(names) else [leaf]
        for name in pair:
            wanted = {part: StateAndMode(LifecycleState.ACTIVE) for part in below}
            systems[name] = SystemModel(name, {DEFAULT_MODE: wanted})
    model = SmhModel({leaf: NodeModel(leaf)}, systems)

    goal = goal_of(model, ModeRequest(names[0][0], DEFAULT_MODE), {leaf: NodeFacts()})

    assert len(goal.targets) == 1 + 2 * 59 + 1
