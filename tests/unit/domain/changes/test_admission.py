"""Whether a change may begin, and what stands against it."""

from collections.abc import Mapping

import pytest

from domain.changes.admission import ADVISORY, ChangeAdmission
from domain.errors import BlockedError, IllegalTransitionError
from domain.findings import Blocker
from domain.inputs import ChangeRequest, ModeRequest, ParametersRequest, TransitionRequest
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import Parameters
from domain.parts.claims import Claims
from domain.parts.mode_inference import ModeInference
from domain.parts.node_doubts import IN_DOUBT
from domain.parts.node_facts import NodeFacts
from domain.parts.system_model import SmhModel, SystemModel
from domain.state_and_mode import ModeName, PartName
from tests.support.big_model import big_model
from tests.support.guards import unguarded
from tests.support.models import ACTUATION, ARM, BASE, actuation_model, inactive, nested_model

S, T = LifecycleState, Transition
ROBOT = PartName("robot")
UNTOLD = None
ESTOP = (Blocker("ESTOP", "e-stop is pressed", ("estop",), value=True, since=7),)
PERFORMANCE = ModeRequest(ACTUATION, "PERFORMANCE")
FAST: Parameters = {"max_speed": 0.9, "controller": "MPC"}


def _node(
    state: LifecycleState | None, *, reachable: bool | None = True, plain: bool = False
) -> NodeFacts:
    return NodeFacts(state, reachable=reachable, has_lifecycle=not plain)


def _doubtful(facts: Mapping[PartName, NodeFacts]) -> set[PartName]:
    return {node for node, known in facts.items() if known.known_state in IN_DOUBT}


def _admission(
    base: NodeFacts | LifecycleState | None = S.UNCONFIGURED,
    arm: NodeFacts | LifecycleState | None = S.UNCONFIGURED,
    model: SmhModel | None = None,
) -> ChangeAdmission:
    facts = {PartName("lidar"): _node(S.INACTIVE)}
    for name, given in ((BASE, base), (ARM, arm)):
        facts[name] = given if isinstance(given, NodeFacts) else _node(given)
    model = model or actuation_model()
    claims = Claims(ModeInference(model))
    return ChangeAdmission(model, facts, _doubtful(facts), unguarded(model), claims)


def _codes(admission: ChangeAdmission, request: ChangeRequest) -> list[str]:
    return [blocker.code for blocker in admission.blockers(request, ())]


# --- legal transitions ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("state", "available"),
    [
        (S.UNCONFIGURED, [T.CONFIGURE, T.ACTIVATE, T.SHUTDOWN]),
        (S.INACTIVE, [T.CLEANUP, T.ACTIVATE, T.SHUTDOWN]),
        (S.ACTIVE, [T.CLEANUP, T.DEACTIVATE, T.SHUTDOWN]),
        (S.FINALIZED, []),
        # On its way: as it will be.
        (S.CONFIGURING, [T.CLEANUP, T.ACTIVATE, T.SHUTDOWN]),
        (S.DEACTIVATING, [T.CLEANUP, T.ACTIVATE, T.SHUTDOWN]),
        # A node that nothing is known of refuses nothing.
        (UNTOLD, list(T)),
    ],
)
def test_what_a_node_can_be_asked_for(
    state: LifecycleState | None, available: list[Transition]
) -> None:
    assert list(_admission(state).available_transitions(BASE, ())) == available


@pytest.mark.parametrize("state", [s for s in S if s is not S.UNKNOWN])
@pytest.mark.parametrize("part", [BASE, ACTUATION])
@pytest.mark.parametrize("transition", T)
def test_what_is_shown_as_available_is_accepted_and_nothing_else_unless_it_is_met(
    part: PartName, state: LifecycleState, transition: Transition
) -> None:
    admission = _admission(state, S.INACTIVE)
    available = admission.available_transitions(part, ())
    try:
        goal = admission.admit(TransitionRequest(part, transition), ())
    except (IllegalTransitionError, BlockedError):
        assert transition not in available
        return
    met = all(want.state is transition.goal for want in goal.nodes.values())
    assert transition in available or met


@pytest.mark.parametrize(
    ("base", "arm", "transition", "legal"),
    [
        # Towards rest one part that can go is enough ...
        (S.UNCONFIGURED, S.ACTIVE, T.DEACTIVATE, True),
        (S.FINALIZED, S.ACTIVE, T.DEACTIVATE, True),
        (S.UNCONFIGURED, UNTOLD, T.DEACTIVATE, True),
        (S.UNCONFIGURED, S.UNCONFIGURED, T.DEACTIVATE, False),
        (S.FINALIZED, S.FINALIZED, T.CLEANUP, False),
        # ... otherwise all must.
        (S.UNCONFIGURED, S.INACTIVE, T.CONFIGURE, True),
        (S.UNCONFIGURED, S.ACTIVE, T.CONFIGURE, False),
        (S.UNCONFIGURED, UNTOLD, T.CONFIGURE, True),
        (S.UNCONFIGURED, S.ACTIVE, T.ACTIVATE, True),
    ],
)
def test_a_transition_of_a_system_is_judged_by_its_nodes(
    base: LifecycleState | None,
    arm: LifecycleState | None,
    transition: Transition,
    *,
    legal: bool,
) -> None:
    admission = _admission(base, arm)
    if legal:
        admission.admit(TransitionRequest(ACTUATION, transition), ())
        return
    with pytest.raises(IllegalTransitionError):
        admission.admit(TransitionRequest(ACTUATION, transition), ())


def test_an_illegal_transition_is_refused_with_the_state_and_what_is_available() -> None:
    with pytest.raises(IllegalTransitionError) as refusal:
        _admission().admit(TransitionRequest(BASE, T.DEACTIVATE), ())
    assert refusal.value.message == "drive_base is unconfigured: it cannot deactivate"
    assert refusal.value.available == (T.CONFIGURE, T.ACTIVATE, T.SHUTDOWN)


def test_an_illegal_transition_under_estop_offers_nothing_that_would_be_refused() -> None:
    with pytest.raises(IllegalTransitionError) as refusal:
        _admission().admit(TransitionRequest(BASE, T.DEACTIVATE), ESTOP)
    assert refusal.value.available == (T.CONFIGURE, T.SHUTDOWN)


def test_a_system_in_mixed_states_is_told_as_such() -> None:
    with pytest.raises(IllegalTransitionError, match="actuation has parts in different states"):
        _admission(S.ACTIVE, S.UNCONFIGURED).admit(TransitionRequest(ACTUATION, T.CONFIGURE), ())


# --- plain nodes ---------------------------------------------------------------------------------


def test_a_plain_node_has_no_transition() -> None:
    admission = _admission(_node(None, plain=True))
    assert admission.available_transitions(BASE, ()) == ()
    for transition in (T.CONFIGURE, T.DEACTIVATE, T.CLEANUP, T.SHUTDOWN):
        with pytest.raises(IllegalTransitionError, match="drive_base is active"):
            admission.admit(TransitionRequest(BASE, transition), ())


def test_a_plain_node_may_be_activated_which_it_is() -> None:
    _admission(_node(None, plain=True)).admit(TransitionRequest(BASE, T.ACTIVATE), ())


def test_a_plain_node_does_not_keep_its_system_from_being_configured() -> None:
    """system_modes, launch test `two_mixed_nodes`."""
    admission = _admission(_node(None, plain=True), S.UNCONFIGURED)
    assert T.CONFIGURE in admission.available_transitions(ACTUATION, ())
    admission.admit(TransitionRequest(ACTUATION, T.CONFIGURE), ())


# --- what stands against it ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("base", "code", "message", "value"),
    [
        (
            _node(S.ACTIVE, reachable=False),
            "UNREACHABLE",
            "drive_base is unreachable",
            None,
        ),
        (
            _node(None, reachable=None),
            "UNKNOWN_STATE",
            "drive_base has never reported a state",
            None,
        ),
        (
            _node(S.FINALIZED),
            "FINALIZED",
            "drive_base is finalized: its process must be restarted",
            "finalized",
        ),
        (
            _node(S.ERROR_PROCESSING),
            "ERROR_PROCESSING",
            "drive_base is processing an error",
            "errorprocessing",
        ),
    ],
    ids=lambda value: value if isinstance(value, str) and value.isupper() else "",
)
def test_a_node_that_stands_against_a_mode_is_named_with_the_way_to_it(
    base: NodeFacts, code: str, message: str, value: str | None
) -> None:
    (blocker,) = _admission(base).blockers(PERFORMANCE, ())
    refuses = code not in ADVISORY
    assert blocker == Blocker(code, message, ("actuation", "drive_base"), value, refuses=refuses)


@pytest.mark.parametrize("state", [S.FINALIZED, S.ERROR_PROCESSING])
@pytest.mark.parametrize(
    "request_",
    [PERFORMANCE, TransitionRequest(ACTUATION, T.ACTIVATE), ModeRequest(BASE, "FAST")],
    ids=str,
)
def test_a_node_that_cannot_be_activated_refuses_the_change(
    request_: ChangeRequest, state: LifecycleState
) -> None:
    with pytest.raises(BlockedError) as refusal:
        _admission(state).admit(request_, ())
    assert [blocker.code for blocker in refusal.value.blockers] == _codes(
        _admission(state), request_
    )


def test_activating_a_system_without_a_mode_is_refused_as_asking_for_default_is() -> None:
    admission = _admission(S.FINALIZED)
    for request in (
        TransitionRequest(ACTUATION, T.ACTIVATE),
        ModeRequest(ACTUATION, "__DEFAULT__"),
    ):
        with pytest.raises(BlockedError, match="drive_base is finalized"):
            admission.admit(request, ())


def test_a_finalized_node_refuses_that_its_system_is_configured() -> None:
    with pytest.raises(BlockedError, match="drive_base is finalized"):
        _admission(S.FINALIZED).admit(TransitionRequest(ACTUATION, T.CONFIGURE), ())


@pytest.mark.parametrize("base", [_node(S.ACTIVE, reachable=False), _node(None, reachable=None)])
def test_an_absent_node_is_shown_but_refuses_nothing(base: NodeFacts) -> None:
    """docs/explanation/semantics.md: accepted, recorded, and failed at the deadline."""
    admission = _admission(base)
    assert len(admission.blockers(PERFORMANCE, ())) == 1
    admission.admit(PERFORMANCE, ())


@pytest.mark.parametrize("transition", [T.DEACTIVATE, T.CLEANUP, T.SHUTDOWN])
@pytest.mark.parametrize("state", [S.FINALIZED, S.ERROR_PROCESSING])
def test_nothing_but_absence_stands_against_going_to_rest(
    transition: Transition, state: LifecycleState
) -> None:
    assert _codes(_admission(state, S.ACTIVE), TransitionRequest(ACTUATION, transition)) == []


def test_a_node_that_is_where_it_should_be_stands_against_nothing() -> None:
    """Even if nothing leads there: a mode may want a finalized node."""
    model = actuation_model()
    wanted = {**model.systems[ACTUATION].modes}
    finalized = inactive().__class__(S.FINALIZED)
    wanted[ModeName("WITHOUT_ARM")] = {ARM: finalized, BASE: inactive()}
    model = SmhModel(model.nodes, {ACTUATION: SystemModel(ACTUATION, wanted)})
    admission = _admission(S.INACTIVE, S.FINALIZED, model)
    assert _codes(admission, ModeRequest(ACTUATION, "WITHOUT_ARM")) == []


def test_parameters_of_a_node_that_has_ended_cannot_be_set() -> None:
    with pytest.raises(BlockedError):
        _admission(S.FINALIZED).admit(ParametersRequest(BASE, {"max_speed": 0.4}), ())


def test_the_way_to_a_node_leads_through_the_systems_between() -> None:
    admission = _admission(S.FINALIZED, model=nested_model())
    (blocker,) = admission.blockers(ModeRequest(ROBOT, "RACE"), ())
    assert blocker.path == ("robot", "actuation", "drive_base")


def test_the_way_to_the_asked_part_itself_is_that_part() -> None:
    (blocker,) = _admission(S.FINALIZED).blockers(ModeRequest(BASE, "FAST"), ())
    assert blocker.path == ("drive_base",)


def test_the_way_to_a_node_that_only_one_mode_names_is_told() -> None:
    model = actuation_model()
    modes = {**model.systems[ACTUATION].modes}
    modes = {mode: {ARM: wanted[ARM]} for mode, wanted in modes.items()}
    modes[ModeName("BOTH")] = {ARM: inactive(), BASE: inactive()}
    model = SmhModel(model.nodes, {ACTUATION: SystemModel(ACTUATION, modes)})
    (blocker,) = _admission(S.FINALIZED, S.INACTIVE, model).blockers(
        ModeRequest(ACTUATION, "BOTH"), ()
    )
    assert blocker.path == ("actuation", "drive_base")


# --- ESTOP ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("base", "request_", "refused"),
    [
        (S.UNCONFIGURED, ModeRequest(BASE, "FAST"), True),
        (S.INACTIVE, TransitionRequest(BASE, T.ACTIVATE), True),
        (S.DEACTIVATING, TransitionRequest(BASE, T.ACTIVATE), True),
        (UNTOLD, ModeRequest(BASE, "FAST"), True),
        (UNTOLD, TransitionRequest(BASE, T.ACTIVATE), True),
        # What activates nothing is allowed.
        (S.ACTIVE, ModeRequest(BASE, "FAST"), False),
        (S.UNCONFIGURED, TransitionRequest(BASE, T.CONFIGURE), False),
        (S.ACTIVE, TransitionRequest(BASE, T.DEACTIVATE), False),
        (S.ACTIVE, TransitionRequest(BASE, T.SHUTDOWN), False),
        (UNTOLD, TransitionRequest(BASE, T.CONFIGURE), False),
        (S.INACTIVE, ParametersRequest(BASE, FAST), False),
    ],
)
def test_under_estop_nothing_is_activated(
    base: LifecycleState | None, request_: ChangeRequest, *, refused: bool
) -> None:
    """docs/explanation/semantics.md, health and changes."""
    admission = _admission(base)
    if not refused:
        admission.admit(request_, ESTOP)
        return
    with pytest.raises(BlockedError) as refusal:
        admission.admit(request_, ESTOP)
    assert "ESTOP" in [blocker.code for blocker in refusal.value.blockers]


def test_a_plain_node_is_not_activated_even_if_nothing_is_heard_of_it() -> None:
    plain = _node(None, reachable=False, plain=True)
    _admission(plain).admit(ModeRequest(BASE, "FAST"), ESTOP)


def test_a_system_of_which_one_node_would_be_activated_is_refused() -> None:
    with pytest.raises(BlockedError):
        _admission(S.ACTIVE, S.INACTIVE).admit(PERFORMANCE, ESTOP)


def test_a_refusal_tells_everything_that_stands_against_it_the_absent_nodes_too() -> None:
    """API: a refusal carries the blockers that the list of modes shows at that moment."""
    admission = _admission(_node(None, reachable=False))
    with pytest.raises(BlockedError) as refusal:
        admission.admit(PERFORMANCE, ESTOP)
    assert refusal.value.blockers == admission.blockers(PERFORMANCE, ESTOP)
    assert [blocker.code for blocker in refusal.value.blockers] == ["ESTOP", "UNREACHABLE"]


def test_estop_is_told_with_the_asked_part_before_the_signal() -> None:
    (blocker,) = _admission().blockers(PERFORMANCE, ESTOP)
    assert blocker == Blocker(
        "ESTOP", "e-stop is pressed", ("actuation", "estop"), value=True, since=7
    )


def test_without_estop_nothing_stands_against_a_healthy_robot() -> None:
    assert _admission().blockers(PERFORMANCE, ()) == ()


def test_what_would_be_refused_under_estop_is_not_shown_as_available() -> None:
    assert list(_admission(S.INACTIVE).available_transitions(BASE, ESTOP)) == [
        T.CLEANUP,
        T.SHUTDOWN,
    ]


def test_of_many_blockers_what_refuses_comes_first_and_the_rest_is_cut() -> None:
    model = big_model(200)
    facts = {node: _node(None) for node in model.nodes}
    last = list(model.nodes)[-1]
    facts[last] = _node(S.FINALIZED)

    claims = Claims(ModeInference(model))
    admission = ChangeAdmission(model, facts, _doubtful(facts), unguarded(model), claims)
    blockers = admission.blockers(ModeRequest(model.parts[0], "FAST"), ())

    assert (len(blockers), blockers[0].code, blockers[0].path[-1]) == (100, "FINALIZED", last)
    assert {blocker.code for blocker in blockers[1:]} == {"UNKNOWN_STATE"}


def test_the_way_to_a_node_passes_by_the_systems_that_it_is_not_in() -> None:
    other = SystemModel(
        PartName("other"), {ModeName("__DEFAULT__"): {PartName("lidar"): inactive()}}
    )
    inner = nested_model()
    modes = {ModeName("__DEFAULT__"): {other.name: inactive(), ACTUATION: inactive()}}
    systems = {**inner.systems, other.name: other, ROBOT: SystemModel(ROBOT, modes)}
    admission = _admission(S.FINALIZED, model=SmhModel(inner.nodes, systems))
    (blocker,) = admission.blockers(ModeRequest(ROBOT, "__DEFAULT__"), ())
    assert blocker.path == (ROBOT, ACTUATION, BASE)


def test_a_refusal_names_the_part_that_was_asked() -> None:
    with pytest.raises(BlockedError) as refusal:
        _admission(S.FINALIZED).admit(PERFORMANCE, ())
    assert refusal.value.message.startswith("actuation cannot be changed: ")


def test_what_refuses_is_told_before_what_is_only_shown_in_the_order_of_the_nodes() -> None:
    admission = _admission(UNTOLD, S.FINALIZED)
    assert _codes(admission, PERFORMANCE) == ["FINALIZED", "UNKNOWN_STATE"]
    admission = _admission(S.FINALIZED, UNTOLD)
    assert _codes(admission, PERFORMANCE) == ["FINALIZED", "UNKNOWN_STATE"]
    admission = _admission(S.FINALIZED, S.ERROR_PROCESSING)
    assert _codes(admission, PERFORMANCE) == ["ERROR_PROCESSING", "FINALIZED"]


# --- what a mode means ---------------------------------------------------------------------------


def test_what_a_mode_means_is_worked_out_once() -> None:
    admission = _admission()

    assert admission.goal(PERFORMANCE) is admission.goal(PERFORMANCE)


def test_what_few_modes_mean_is_remembered_those_that_were_asked_for_last() -> None:
    model = big_model(100)
    claims = Claims(ModeInference(model))
    admission = ChangeAdmission(model, {}, set(), unguarded(model), claims)
    requests = [ModeRequest(system, "FAST") for system in list(model.systems)[:9]]
    first = [admission.goal(request) for request in requests[:8]]
    asked_again = admission.goal(requests[0])
    admission.goal(requests[8])

    assert asked_again is first[0]
    assert admission.goal(requests[0]) is first[0]
    assert admission.goal(requests[1]) == first[1]
    assert admission.goal(requests[1]) is not first[1]
