"""A part has converged once it and all its parts are where their targets say."""

import hypothesis.strategies as st
import pytest
from hypothesis import given

from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState as S
from domain.parts.convergence import MAX_REASON, Convergence, is_there
from domain.parts.mode_inference import ModeInference
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from tests.support.big_model import FAST, PARAMETERS, big_model
from tests.support.models import ACTUATION, ARM, BASE, active, actuation_model, inactive
from tests.support.random_models import SetTarget, histories, models

UNCONFIGURED = StateAndMode(S.UNCONFIGURED)


# --- whatever happens ----------------------------------------------------------------------------


def cause(inference: ModeInference, part: PartName) -> PartName | None:
    """Return by recursion the last deepest part that is not where its target says."""
    target = inference.target(part)
    system = inference.model.systems.get(part)
    if system is not None:
        mode = target.mode if target is not None else None
        wanted = system.modes.get(mode or DEFAULT_MODE, {})
        below = {*system.parts, *wanted}
        for child in reversed(system.named_parts):
            deepest = cause(inference, child) if child in below else None
            if deepest is not None:
                return deepest
    actual = inference.actual(part)
    if target is None or is_there(actual, target):
        return None
    facts = inference.facts.get(part)
    is_plain = facts is not None and not facts.has_lifecycle
    if is_plain and actual.state is S.ACTIVE and target.state is not S.ACTIVE:
        return None
    return part


@given(st.data())
def test_whatever_happens_a_part_has_converged_when_it_and_all_below_are_there(
    data: st.DataObject,
) -> None:
    model = data.draw(models())
    inference = ModeInference(model)
    for happening in data.draw(histories(model)):
        if isinstance(happening, SetTarget):
            inference.set_targets({happening.part: happening.target})
        else:
            inference.report(happening)
        for part in model.parts:
            deepest = cause(inference, part)
            assert inference.converged(part) is (deepest is None)
            assert (inference.deviation_reason(part) or "").startswith(deepest or "")


@given(st.data())
def test_many_targets_set_at_once_are_judged_like_one_after_the_other(data: st.DataObject) -> None:
    model = data.draw(models())
    happenings = data.draw(histories(model))
    at_once, in_turn = ModeInference(model), ModeInference(model)
    for inference in (at_once, in_turn):
        for happening in happenings:
            if isinstance(happening, NodeReport):
                inference.report(happening)
    targets = {h.part: h.target for h in happenings if isinstance(h, SetTarget)}
    at_once.set_targets(targets)
    for part, target in targets.items():
        in_turn.set_targets({part: target})
    for part in model.parts:
        assert at_once.deviation_reason(part) == in_turn.deviation_reason(part)


# --- what is told --------------------------------------------------------------------------------


def asked(**states: str) -> ModeInference:
    """Return the actuation whose parts were asked to be inactive, and the states that they have."""
    inference = ModeInference(actuation_model())
    inference.set_targets(dict.fromkeys((ACTUATION, BASE, ARM), inactive()))
    for node, state in states.items():
        inference.report(NodeReport(PartName(node), state=S(state)))
    return inference


def test_nodes_that_refused_to_configure_keep_their_system_from_having_converged() -> None:
    inference = asked(drive_base="unconfigured", manipulator="unconfigured")
    assert inference.actual(ACTUATION).state is S.INACTIVE
    assert not inference.converged(ACTUATION)
    assert inference.deviation_reason(ACTUATION) == "drive_base is unconfigured, target inactive"


def test_it_has_converged_with_its_last_node() -> None:
    inference = asked(drive_base="inactive", manipulator="unconfigured")
    assert inference.deviation_reason(ACTUATION) == "manipulator is unconfigured, target inactive"
    changed = inference.report(NodeReport(ARM, state=S.INACTIVE))
    assert changed == {ARM, ACTUATION}
    assert inference.converged(ACTUATION)
    assert inference.deviation_reason(ACTUATION) is None


def test_the_reason_says_why_the_state_of_a_part_is_not_known() -> None:
    inference = asked(drive_base="inactive")
    inference.report(NodeReport(ARM, reachable=False))
    reason = "manipulator is unknown, target inactive: manipulator is unreachable"
    assert inference.deviation_reason(ACTUATION) == reason


def test_a_system_whose_parts_are_there_may_still_not_be_where_it_should() -> None:
    inference = asked(drive_base="inactive", manipulator="inactive")
    inference.set_targets({BASE: UNCONFIGURED, ACTUATION: active("PERFORMANCE")})
    inference.report(NodeReport(BASE, state=S.UNCONFIGURED))
    reason = inference.deviation_reason(ACTUATION)
    assert reason == "actuation is activating, target active.PERFORMANCE"


def test_a_part_that_only_another_mode_names_does_not_count() -> None:
    node, extra, system = PartName("node"), PartName("extra"), PartName("system")
    mode = ModeName("MORE")
    default = {node: inactive()}
    model = SmhModel(
        {node: NodeModel(node), extra: NodeModel(extra)},
        {
            system: SystemModel(
                system, {DEFAULT_MODE: default, mode: {**default, extra: inactive()}}
            )
        },
    )
    inference = ModeInference(model)
    inference.set_targets({system: active(DEFAULT_MODE), node: inactive(), extra: inactive()})
    for part in (node, extra):
        inference.report(NodeReport(part, state=S.INACTIVE))
    inference.report(NodeReport(extra, state=S.UNCONFIGURED))
    assert inference.converged(system)
    inference.set_targets({system: active(mode)})
    assert inference.actual(system).state is S.ACTIVE
    assert inference.deviation_reason(system) == "extra is unconfigured, target inactive"


def test_a_transition_of_its_system_asks_nothing_of_a_plain_node() -> None:
    inference = asked(drive_base="inactive")
    inference.report(NodeReport(ARM, has_lifecycle=False))
    assert inference.actual(ARM).state is S.ACTIVE
    assert (inference.converged(ARM), inference.converged(ACTUATION)) == (True, True)
    inference.report(NodeReport(ARM, reachable=False))
    assert (inference.converged(ARM), inference.converged(ACTUATION)) == (False, False)


def test_a_node_that_turns_out_to_have_a_lifecycle_is_judged_by_it() -> None:
    inference = asked(drive_base="inactive")
    inference.report(NodeReport(ARM, state=S.ACTIVE, has_lifecycle=False))
    inference.report(NodeReport(ARM, has_lifecycle=True))
    assert inference.deviation_reason(ACTUATION) == "manipulator is active, target inactive"


def test_a_reason_is_short_whatever_the_names_are() -> None:
    name = PartName("n" * 1_000)
    inference = ModeInference(SmhModel({name: NodeModel(name)}, {}))
    inference.set_targets({name: inactive()})
    assert len(inference.deviation_reason(name) or "") <= MAX_REASON + len("...")


# --- what it costs -------------------------------------------------------------------------------


@pytest.fixture
def judged(monkeypatch: pytest.MonkeyPatch) -> list[PartName]:
    """Return the parts that are judged from now on."""
    found: list[PartName] = []
    judge = Convergence._cause  # noqa: SLF001

    def count(convergence: Convergence, part: PartName) -> PartName | None:
        found.append(part)
        return judge(convergence, part)

    monkeypatch.setattr(Convergence, "_cause", count)
    return found


def test_a_node_that_is_not_the_last_laggard_concerns_no_system(judged: list[PartName]) -> None:
    inference = ModeInference(big_model(10_000))
    inference.set_targets(dict.fromkeys(inference.model.parts, active(FAST)))
    judged.clear()
    inference.report(NodeReport(PartName("node_5001"), S.CONFIGURING))
    assert len(judged) <= 2


def test_a_node_concerns_at_most_the_systems_above_it(judged: list[PartName]) -> None:
    model = big_model(1_000)
    inference = ModeInference(model)
    inference.set_targets(dict.fromkeys(model.parts, active(FAST)))
    judged.clear()
    for node in model.nodes:
        inference.report(NodeReport(node, S.ACTIVE, parameters=PARAMETERS[FAST]))
    assert inference.converged(model.parts[0])
    assert len(judged) <= len(model.nodes) * (1 + len(model.ancestors[next(iter(model.nodes))]))
