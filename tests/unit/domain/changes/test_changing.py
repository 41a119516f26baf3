"""Changes as a concern: what it takes, and in which order things follow."""

import pytest

from domain.changes.changing import Changing
from domain.changes.settings import ChangeSettings
from domain.errors import BackendUnavailableError
from domain.health.health import Health
from domain.health.part_errors import PartErrors
from domain.health.signals import default_signals
from domain.inputs import BackendStatus, Input, ModeRequest, NodeReport
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox, Outputs
from domain.parts.parts import Parts
from domain.snapshot import ModeView
from domain.state_and_mode import PartName
from tests.support.guards import unguarded
from tests.support.models import ARM, BASE, FAST, actuation_model


class Robot:
    """Parts and changes alone, handed inputs as the supervision does."""

    def __init__(self) -> None:
        self.outbox = Outbox()
        self.parts = Parts(actuation_model(), self.outbox)
        health = Health(default_signals(), self.outbox, 0)
        part_errors = PartErrors(self.parts, health.error_list, self.outbox, 0)
        settings = ChangeSettings(restored_nodes=frozenset({BASE}))
        guards = unguarded(self.parts.model)
        self.changing = Changing(self.parts, health, part_errors, settings, self.outbox, guards)

    def hand_in(self, given: Input, now: int = 0) -> Outputs:
        for concern in (self.parts, self.changing):
            take = concern.takes.get(type(given))
            if take is not None:
                take(given, now)
        while self.parts.settle(now) or self.changing.settle(now):
            pass
        return self.outbox.take()

    def modes(self, part: PartName) -> list[ModeView]:
        return [self.changing.mode(part, mode) for mode in self.parts.model.modes_of(part)]


def test_a_report_is_judged_after_the_parts_took_it_in() -> None:
    robot = Robot()
    robot.hand_in(NodeReport(BASE, state=LifecycleState.INACTIVE))
    robot.hand_in(ModeRequest(BASE, FAST))

    outputs = robot.hand_in(NodeReport(BASE, parameters={"max_speed": 0.9, "controller": "MPC"}))

    kinds = [event.kind for event in outputs.events]
    assert kinds[0] == "node.reported"
    assert kinds.index("change.step_ended") < kinds.index("change.step_started")


def test_a_node_that_reappears_is_restored_once_all_else_has_settled() -> None:
    robot = Robot()
    robot.hand_in(NodeReport(BASE, state=LifecycleState.INACTIVE))
    robot.hand_in(ModeRequest(BASE, FAST))
    robot.hand_in(NodeReport(BASE, parameters={"max_speed": 0.9, "controller": "MPC"}))
    robot.hand_in(NodeReport(BASE, state=LifecycleState.ACTIVE))

    outputs = robot.hand_in(NodeReport(BASE, state=LifecycleState.UNCONFIGURED, reachable=True))

    kinds = [event.kind for event in outputs.events]
    assert kinds.index("part.deviation_began") < kinds.index("node.restoring")


def test_while_the_backend_is_unavailable_nothing_is_asked_of_nodes() -> None:
    robot = Robot()
    told = robot.hand_in(BackendStatus(available=False, reason="no route"))
    assert [event.kind for event in told.events] == ["backend.unavailable"]

    with pytest.raises(BackendUnavailableError):
        robot.hand_in(ModeRequest(ARM, "STRONG"))
    assert robot.hand_in(BackendStatus(available=False)).events == ()


def test_without_a_backend_no_mode_can_be_entered_and_that_is_said_first() -> None:
    robot = Robot()
    robot.hand_in(NodeReport(BASE, state=LifecycleState.FINALIZED))
    robot.hand_in(BackendStatus(available=False, reason="no network"), 7)

    for view in robot.modes(BASE):
        down = view.blockers[0]
        assert not view.can_enter
        assert (down.code, down.message) == (
            "BACKEND_UNAVAILABLE",
            "the nodes cannot be reached: no network",
        )
        assert (down.path, down.since, down.refuses) == ((BASE,), 7, True)
        assert [blocker.code for blocker in view.blockers[1:]] == ["FINALIZED"]
    assert robot.changing.available_transitions(ARM) == ()


def test_with_its_backend_back_a_mode_can_be_entered_again() -> None:
    robot = Robot()
    robot.hand_in(NodeReport(BASE, state=LifecycleState.INACTIVE))
    robot.hand_in(BackendStatus(available=False, reason="no network"))
    robot.hand_in(BackendStatus(available=True))

    assert all(view.can_enter and not view.blockers for view in robot.modes(BASE))
    assert robot.changing.available_transitions(BASE)
