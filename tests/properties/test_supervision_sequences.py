"""Whatever is asked, read and broken in any order: every change ends, and what is wrong is told.

`make soak` runs 10,000 sequences, `make test` 500.
"""

import os
from collections.abc import Mapping

import hypothesis.strategies as st
from hypothesis import settings
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from domain.changes.settings import ChangeSettings
from domain.errors import PilothouseError
from domain.events.event import RecordedEvent
from domain.inputs import (
    AcknowledgeRequest,
    BackendStatus,
    CancelRequest,
    Input,
    ModeRequest,
    ParametersRequest,
    TransitionRequest,
)
from domain.lifecycle import Transition
from domain.outbox import Outputs
from domain.simulation.node_settings import Fault
from domain.snapshot import ChangeStatus, StepStatus, SystemState
from domain.state_and_mode import ModeName, PartName
from domain.supervision import SupervisionSettings
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import ACTUATION, ARM, BASE, nested_model

MODEL = nested_model()
PARTS = st.sampled_from(MODEL.parts)
NODES = st.sampled_from(tuple(MODEL.nodes))
INPUTS = frozenset(
    {
        "backend.unavailable",
        "change.cancel_requested",
        "change.requested",
        "emergency_stop.engaged",
        "emergency_stop.released",
        "error.acknowledged",
        "node.answered",
        "node.reported",
        "signal.read",
        "time.passed",
    }
)


class Sequences(RuleBasedStateMachine):
    """An operator, a robot and bad luck."""

    def __init__(self) -> None:
        super().__init__()
        changes = ChangeSettings(restored_nodes=frozenset({BASE, ARM}))
        self.robot = CoreRobot(MODEL, SupervisionSettings(changes=changes))
        self.robot.read(**GOOD)
        self.checked = 0

    def ask(self, request: Input) -> Outputs:
        """Ask for something that may be refused; a refusal changes nothing."""
        before = self.robot.core.parts()
        changes = self.robot.core.changes()
        try:
            return self.robot.give(request)
        except PilothouseError:
            assert self.robot.core.parts() == before
            assert self.robot.core.changes() == changes
            return Outputs()

    @rule(part=PARTS, data=st.data())
    def ask_for_a_mode(self, part: PartName, data: st.DataObject) -> None:
        modes = MODEL.modes_of(part)
        mode = data.draw(st.sampled_from([*modes, ModeName("NO_SUCH")]))
        enterable = {view.mode: view for view in self.robot.core.modes(part)}.get(mode)
        begun = self.ask(ModeRequest(part, mode)).change
        taken = begun is not None
        assert taken is (enterable is not None and enterable.can_enter)
        if begun is not None:
            assert self.robot.change(begun).request == ModeRequest(part, mode)

    @rule(part=PARTS, transition=st.sampled_from(Transition))
    def ask_for_a_transition(self, part: PartName, transition: Transition) -> None:
        available = self.robot.core.available_transitions(part)
        begun = self.ask(TransitionRequest(part, transition)).change
        if transition in available:
            assert begun is not None, "available, and yet refused"

    @rule(speed=st.floats(0, 1), controller=st.sampled_from(["PID", "MPC"]))
    def set_parameters(self, speed: float, controller: str) -> None:
        self.ask(ParametersRequest(BASE, {"max_speed": speed, "controller": controller}))

    @precondition(lambda self: self.robot.core.changes())
    @rule(data=st.data())
    def cancel(self, data: st.DataObject) -> None:
        change = data.draw(st.sampled_from(self.robot.core.changes()))
        self.ask(CancelRequest(change.id))

    @rule(node=NODES, fault=st.sampled_from([None, None, *Fault]))
    def break_or_mend(self, node: PartName, fault: Fault | None) -> None:
        self.robot.fault(node, fault)

    @rule(available=st.booleans())
    def lose_or_regain_the_backend(self, *, available: bool) -> None:
        self.robot.give(BackendStatus(available, "" if available else "no network"))
        for part in MODEL.parts:
            for view in self.robot.core.modes(part):
                codes = [blocker.code for blocker in view.blockers if blocker.refuses]
                assert view.can_enter is not bool(codes)
                assert ("BACKEND_UNAVAILABLE" in codes) is not available

    @rule(engaged=st.booleans())
    def press_or_release_the_emergency_stop(self, *, engaged: bool) -> None:
        if engaged:
            self.robot.stop()
        else:
            self.robot.release_stop()

    @rule(estop=st.booleans(), battery=st.sampled_from([0.1, 0.9]))
    def read_signals(self, *, estop: bool, battery: float) -> None:
        self.robot.read(**{**GOOD, "estop": estop, "battery_level": battery})

    @rule()
    def acknowledge(self) -> None:
        self.ask(AcknowledgeRequest("ESTOP"))

    @rule(duration_s=st.sampled_from([0.001, 0.02, 0.1, 0.3, 1.0, 3.0, 11.0]))
    def wait(self, duration_s: float) -> None:
        self.robot.advance(duration_s)

    @invariant()
    def error_and_bits_are_of_one_moment(self) -> None:
        state = self.robot.core.system_state()
        assert (state.error_code != 0) is (state.state is SystemState.ERROR)
        assert bool(state.reasons) is (state.error_code != 0)

    @invariant()
    def a_deviation_is_told_and_caused(self) -> None:
        by_id = {event.id: event for event in self.robot.events}
        told = _deviating(self.robot.events)
        for part, view in self.robot.core.parts().items():
            assert view.converged is (part not in told)
            if part in told:
                assert view.deviation_since == told[part].at
                assert _root(told[part], by_id).kind in INPUTS

    @invariant()
    def one_step_in_flight_per_node(self) -> None:
        running = [
            step.node
            for change in self.robot.core.changes()
            for step in change.steps
            if step.status is StepStatus.RUNNING
        ]
        assert len(running) == len(set(running))

    @invariant()
    def what_nobody_asked_for_supersedes_nothing(self) -> None:
        unasked = {e.id for e in self.robot.events if e.kind == "node.restoring"}
        restoring = {c.id for c in self.robot.core.changes() if c.cause in unasked}
        for change in self.robot.core.changes():
            if change.status is ChangeStatus.SUPERSEDED:
                assert change.reason is not None
                _, _, _, newer, *_ = change.reason.split()
                assert newer not in restoring

    def teardown(self) -> None:
        """After a minute without a new request everything has ended."""
        self.robot.advance(60)
        for change in self.robot.core.changes():
            assert change.status is not ChangeStatus.RUNNING
            assert change.ended_at is not None
            ended = [step for step in change.steps if step.status is not StepStatus.RUNNING]
            assert len(ended) == len(change.steps)
            assert (change.reason is None) is (change.status is ChangeStatus.SUCCEEDED)
        self.a_deviation_is_told_and_caused()
        assert ACTUATION in self.robot.core.parts()
        assert ARM in self.robot.core.parts()


def _deviating(events: list[RecordedEvent]) -> dict[PartName, RecordedEvent]:
    told: dict[PartName, RecordedEvent] = {}
    for event in events:
        part = PartName(str(event.data.get("part")))
        if event.kind == "part.deviation_began":
            told[part] = event
        elif event.kind == "part.deviation_ended":
            del told[part]
    return told


def _root(event: RecordedEvent, by_id: Mapping[int, RecordedEvent]) -> RecordedEvent:
    while event.cause is not None:
        assert event.cause < event.id
        event = by_id[event.cause]
    return event


SOAK = bool(os.environ.get("PILOTHOUSE_SOAK"))
Sequences.TestCase.settings = settings(
    max_examples=10_000 if SOAK else 100, stateful_step_count=30, deadline=None
)
TestSequences = Sequences.TestCase
