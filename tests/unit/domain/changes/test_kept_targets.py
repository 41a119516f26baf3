"""Targets are as they were after a restart, and no more is kept for that than was requested."""

from contextlib import suppress

import hypothesis.strategies as st
from hypothesis import given, settings

from domain.changes.kept_targets import KeptTargets
from domain.changes.plan import targets_of
from domain.errors import PilothouseError
from domain.events.service import TimeWasDue
from domain.inputs import Input, ModeRequest, NodeReport, TimePassed, TransitionRequest
from domain.kept import KeptTarget
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outbox
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.snapshot import EffectiveTarget
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.big_model import big_model
from tests.support.kept_values import KeptValues
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    FAST,
    PERFORMANCE,
    active,
    actuation_model,
    inactive,
)
from tests.support.random_models import models

S = LifecycleState
ROBOT, DOCK, LIGHT = PartName("robot"), PartName("dock"), PartName("light")
DOCKED = ModeName("DOCKED")
UNCONFIGURED = StateAndMode(S.UNCONFIGURED)


class Kept:
    """What the requests of a model leave to be kept."""

    def __init__(self, model: SmhModel | None = None) -> None:
        self.model = model or actuation_model()
        self.outbox = Outbox()
        self.targets = KeptTargets(self.model, self.outbox)
        self.values = KeptValues()

    def request(self, part: PartName, target: StateAndMode, *staying: PartName) -> None:
        """Request something of a part; what is unconfigured stays so."""
        targets = targets_of(self.model, part, target) | dict.fromkeys(staying, UNCONFIGURED)
        self.targets.note(part, targets)
        self.values.take(self.outbox.take())

    @property
    def requests(self) -> list[tuple[str, str]]:
        """Return part and target of what is kept, in the order of the requests."""
        kept = [value for value in self.values.of(KeptTarget) if isinstance(value, KeptTarget)]
        return [(k.part, k.target.label) for k in sorted(kept, key=lambda value: value.order)]

    def restart(self, model: SmhModel | None = None) -> tuple[dict[PartName, StateAndMode], "Kept"]:
        """Return the targets after a restart, and what is kept from then on."""
        after = Kept(model or self.model)
        after.values = self.values
        after.outbox.begin(0, TimeWasDue())
        targets = {
            part: target
            for request in after.targets.restore(self.values.restored().kept)
            for part, target in request.items()
        }
        return targets, after


def docking_model(*modes: ModeName) -> SmhModel:
    """Return a robot one mode of which has a part more than the others."""
    more = {DOCKED: {DOCK: active(), LIGHT: active()}}
    default = {DEFAULT_MODE: {LIGHT: active()}}
    nodes = {name: NodeModel(name, {DEFAULT_MODE: {"p": 1}}) for name in (DOCK, LIGHT)}
    wanted = {mode: (default | more)[mode] for mode in (DEFAULT_MODE, *modes)}
    return SmhModel(nodes, {ROBOT: SystemModel(ROBOT, wanted)})


# --- what is kept --------------------------------------------------------------------------------


def test_a_mode_of_a_system_of_a_thousand_nodes_is_one_value() -> None:
    kept = Kept(big_model(1_000))
    system = next(iter(kept.model.systems))
    kept.request(system, active())

    assert kept.requests == [(system, "active.__DEFAULT__")]


def test_a_request_is_forgotten_once_a_later_one_covers_all_its_parts() -> None:
    kept = Kept()
    kept.request(BASE, active(FAST))
    kept.request(ACTUATION, active(PERFORMANCE))

    assert kept.requests == [(ACTUATION, "active.PERFORMANCE")]


def test_a_request_of_a_system_is_kept_as_long_as_some_part_has_its_target_from_it() -> None:
    kept = Kept()
    kept.request(ACTUATION, active(PERFORMANCE))
    kept.request(BASE, inactive())
    kept.request(ARM, inactive())
    assert kept.requests[0] == (ACTUATION, "active.PERFORMANCE"), "the target of the system itself"

    kept.request(ACTUATION, inactive())
    assert kept.requests == [(ACTUATION, "inactive")]


def test_the_last_of_a_hundred_requests_of_a_part_is_kept() -> None:
    kept = Kept()
    for number in range(100):
        kept.request(BASE, inactive() if number % 2 else active(FAST))

    assert kept.requests == [(BASE, "inactive")]


# --- what comes back -----------------------------------------------------------------------------


def test_a_part_that_only_an_earlier_mode_names_keeps_its_target() -> None:
    kept = Kept(docking_model(DOCKED))
    kept.request(ROBOT, active(DOCKED))
    kept.request(ROBOT, active())

    targets, _ = kept.restart()
    assert targets == {ROBOT: active(), DOCK: active(), LIGHT: active()}
    assert kept.requests == [(ROBOT, "active.DOCKED"), (ROBOT, "active.__DEFAULT__")]


def test_a_node_that_stayed_unconfigured_when_its_system_was_deactivated_is_to_stay_so() -> None:
    kept = Kept()
    kept.request(ACTUATION, inactive(), ARM)

    targets, _ = kept.restart()
    assert targets == {ACTUATION: inactive(), BASE: inactive(), ARM: UNCONFIGURED}


def test_requests_prevail_in_their_order_also_those_after_a_restart() -> None:
    kept = Kept()
    kept.request(ACTUATION, active(PERFORMANCE))
    kept.request(BASE, inactive())
    _, after = kept.restart()
    after.request(ARM, inactive())

    targets, _ = after.restart()
    assert targets == {ACTUATION: active(PERFORMANCE), BASE: inactive(), ARM: inactive()}


def test_a_request_of_before_a_restart_is_forgotten_once_a_later_one_covers_it() -> None:
    kept = Kept()
    kept.request(BASE, inactive())
    _, after = kept.restart()
    after.request(ACTUATION, active(PERFORMANCE))

    assert after.requests == [(ACTUATION, "active.PERFORMANCE")]


# --- another model -------------------------------------------------------------------------------


def told(kept: Kept) -> list[str]:
    outputs = kept.values.take(kept.outbox.take())
    return [e.event.words for e in outputs.events if e.kind == "service.not_restored"]


def test_a_part_that_the_model_no_longer_has_is_left_out_and_told_once() -> None:
    kept = Kept()
    kept.request(BASE, active(FAST))
    kept.request(ARM, inactive())
    targets, after = kept.restart(docking_model())

    assert targets == {}
    assert told(after) == [
        "the target active.FAST of drive_base is not restored: the model has no part 'drive_base'",
        "the target inactive of manipulator is not restored: the model has no part 'manipulator'",
    ]
    assert after.requests == []


def test_a_mode_that_the_model_no_longer_has_is_left_out_and_told() -> None:
    kept = Kept(docking_model(DOCKED))
    kept.request(ROBOT, active(DOCKED))
    kept.request(LIGHT, inactive())
    targets, after = kept.restart(docking_model())

    assert targets == {LIGHT: inactive()}
    assert told(after) == [
        "the target active.DOCKED of robot is not restored: robot has no mode 'DOCKED'"
    ]


def test_a_node_that_was_to_stay_as_it_is_and_is_gone_is_no_obstacle() -> None:
    kept = Kept()
    kept.request(ACTUATION, inactive(), ARM)
    base_alone = SystemModel(ACTUATION, {DEFAULT_MODE: {BASE: inactive()}})
    base_only = SmhModel({BASE: NodeModel(BASE)}, {ACTUATION: base_alone})

    targets, _ = kept.restart(base_only)
    assert targets == {ACTUATION: inactive(), BASE: inactive()}


# --- all of it -----------------------------------------------------------------------------------


RESTING = st.sampled_from([S.UNCONFIGURED, S.UNCONFIGURED, S.INACTIVE, S.ACTIVE, S.FINALIZED])


@st.composite
def inputs(draw: st.DrawFn, model: SmhModel) -> list[Input]:
    """Return what nodes report and operators request, in any order."""
    nodes, parts = st.sampled_from(list(model.nodes)), st.sampled_from(model.parts)
    reports = st.builds(
        NodeReport, nodes, state=RESTING, reachable=st.sampled_from([True, True, False])
    )
    modes = parts.flatmap(
        lambda part: st.builds(
            ModeRequest, st.just(part), st.sampled_from(model.modes_of(part) or (DEFAULT_MODE,))
        )
    )
    transitions = st.builds(TransitionRequest, parts, st.sampled_from(Transition))
    return draw(st.lists(reports | modes | transitions, max_size=12))


def play(core: Supervision, story: list[Input], kept: KeptValues) -> None:
    """Let a story happen; what is rejected changes nothing."""
    for number, given_ in enumerate(story):
        with suppress(PilothouseError):
            kept.take(core.handle(given_, seconds(number)))
    kept.take(core.handle(TimePassed(), seconds(len(story))))


def asked(core: Supervision) -> list[tuple[StateAndMode | None, EffectiveTarget | None]]:
    return [(view.target, view.effective_target) for view in core.parts().values()]


@settings(max_examples=300)
@given(st.data())
def test_whatever_was_requested_targets_are_as_before(data: st.DataObject) -> None:
    model = data.draw(models())
    kept, before = KeptValues(), Supervision(model, SupervisionSettings(), 0)
    for _ in range(2):
        play(before, data.draw(inputs(model)), kept)
        after = Supervision(model, SupervisionSettings(), 0)
        kept.take(after.handle(kept.restored(), 0))

        assert asked(after) == asked(before)
        with_target = [part for part in model.parts if before.part(part).target is not None]
        assert len(kept.of(KeptTarget)) <= len(with_target)
        before = after
