"""One node at a time: its steps, their deadlines and how they end."""

import pytest

from domain.commands import AskFacts, AskParameters, AskTransition
from domain.health.part_errors import DEVIATES_AFTER
from domain.inputs import (
    EmergencyStopRequest,
    ModeRequest,
    NodeAnswer,
    NodeReport,
    ParametersRequest,
    Reading,
    Readings,
    ReportBacklog,
    TimePassed,
    TransitionRequest,
)
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import Parameters
from domain.parts.system_model import NodeModel, SmhModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.snapshot import ChangeStatus, StepStatus
from domain.state_and_mode import DEFAULT_MODE
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import (
    BASE,
    FAST,
    SLOW,
    actuation_model,
)


@pytest.fixture
def robot() -> CoreRobot:
    robot = CoreRobot(actuation_model())
    robot.read(**GOOD)
    return robot


def test_a_slow_node_is_asked_for_its_state_before_it_is_called_late() -> None:
    slow = NodeSettings(configure=seconds(30))
    robot = CoreRobot(actuation_model(), nodes={"drive_base": slow})
    robot.read(**GOOD)
    change = robot.ask_transition("drive_base", "configure")
    robot.advance(9.9)
    assert robot.change(change).status is ChangeStatus.RUNNING
    robot.advance(0.2)
    assert robot.change(change).status is ChangeStatus.TIMED_OUT
    assert robot.change(change).reason == "drive_base: configure: the node is still configuring"


def test_a_node_that_swallowed_its_report_is_found_done_when_asked(robot: CoreRobot) -> None:
    change = robot.ask_transition("drive_base", "configure")
    robot.fault("drive_base", Fault.SILENT)
    robot.advance(2)
    robot.fault("drive_base", None)
    robot.advance(0)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED


def test_an_absent_node_that_comes_before_the_deadline_is_brought_along() -> None:
    robot = CoreRobot(actuation_model(), nodes={"drive_base": NodeSettings(fault=Fault.DIE)})
    robot.read(**GOOD)
    change = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(5)
    robot.fault("drive_base", None)
    robot.advance(2)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert robot.actual("actuation") == "active.PERFORMANCE"


def test_deactivating_never_configures_even_if_the_node_falls_back_meanwhile(
    robot: CoreRobot,
) -> None:
    robot.fault("drive_base", Fault.FAIL)
    robot.ask_transition("drive_base", "configure")
    robot.advance(0.1)
    change = robot.ask_transition("drive_base", "deactivate")
    robot.advance(2)
    view = robot.change(change)
    assert (view.status, view.steps) == (ChangeStatus.FAILED, ())
    assert view.reason == "drive_base is unconfigured, not inactive"


def test_a_node_that_reports_its_mode_late_is_asked_once_and_waited_for(
    robot: CoreRobot,
) -> None:
    robot.ask_mode("drive_base", "FAST")
    robot.advance(2)
    robot.give(NodeReport(BASE, mode=FAST))
    change = robot.ask_mode("drive_base", "SLOW")
    robot.advance(0.5)
    assert robot.steps(change) == [("drive_base", "set_parameters", "running")]
    robot.give(NodeReport(BASE, mode=SLOW))
    assert robot.change(change).status is ChangeStatus.SUCCEEDED


def test_a_mode_with_lists_is_reached_and_verified() -> None:
    limits = NodeModel(BASE, {DEFAULT_MODE: {"limits": (1.0, 2.0)}, FAST: {"limits": (3.0,)}})
    robot = CoreRobot(SmhModel({BASE: limits}, {}))
    robot.read(**GOOD)
    change = robot.ask_mode("drive_base", "FAST")
    robot.advance(2)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert robot.actual("drive_base") == "active.FAST"


def test_what_waits_for_a_step_in_flight_shows_what_it_will_do(robot: CoreRobot) -> None:
    robot.ask_transition("drive_base", "configure")
    robot.advance(0.1)
    change = robot.ask_mode("drive_base", "SLOW")
    assert robot.steps(change)[-1] == ("drive_base", "activate", "pending")


def test_a_step_that_was_never_begun_did_not_time_out() -> None:
    robot = CoreRobot(actuation_model(), nodes={"drive_base": NodeSettings(configure=seconds(60))})
    robot.read(**GOOD)
    robot.ask_transition("drive_base", "configure")
    robot.advance(1)
    change = robot.ask_transition("drive_base", "shutdown")
    robot.advance(30)
    assert robot.change(change).status is ChangeStatus.FAILED
    assert robot.change(change).reason == "drive_base is still configuring; no step was started"


def _core() -> Supervision:
    core = Supervision(actuation_model(), SupervisionSettings(), 0)
    core.handle(NodeReport(BASE, state=LifecycleState.UNCONFIGURED), 0)
    return core


def _configure(core: Supervision) -> None:
    core.handle(TransitionRequest(BASE, Transition.CONFIGURE), 0)


def test_a_node_that_answers_nothing_at_all_times_out_after_it_was_asked_for_its_state() -> None:
    core = _core()
    _configure(core)
    assert core.handle(TimePassed(), seconds(10)).commands[-1:] == (AskFacts(2, BASE),)
    core.handle(TimePassed(), seconds(11) - 1)
    assert core.change("c1").status is ChangeStatus.RUNNING
    core.handle(TimePassed(), seconds(11))
    assert core.change("c1").status is ChangeStatus.TIMED_OUT
    assert core.change("c1").reason == (
        "drive_base: configure: not done within 10 s, and the node did not answer a query of"
        " its state"
    )


def test_no_node_is_late_while_its_report_may_wait_to_be_taken_in() -> None:
    core = _core()
    _configure(core)
    core.handle(ReportBacklog("nodes", since=seconds(9)), seconds(9.5))
    core.handle(TimePassed(), seconds(30))
    assert core.change("c1").status is ChangeStatus.RUNNING
    due = core.wake_at()
    assert due is None or due > seconds(30), "it does not become due again and again"
    core.handle(NodeReport(BASE, state=LifecycleState.INACTIVE), seconds(30))
    assert core.change("c1").status is ChangeStatus.SUCCEEDED


def test_a_node_is_late_once_all_that_came_before_its_deadline_is_taken_in() -> None:
    core = _core()
    _configure(core)
    core.handle(ReportBacklog("nodes", since=seconds(9)), seconds(9.5))
    core.handle(ReportBacklog("others", since=seconds(40)), seconds(12))
    assert core.handle(TimePassed(), seconds(12)).commands == ()
    core.handle(ReportBacklog("nodes", since=seconds(11)), seconds(12))
    assert core.handle(TimePassed(), seconds(12)).commands == (AskFacts(2, BASE),)
    core.handle(ReportBacklog("nodes", since=None), seconds(14))
    core.handle(TimePassed(), seconds(14))
    assert core.change("c1").status is ChangeStatus.TIMED_OUT


@pytest.mark.parametrize(
    ("reason", "told"), [("", "rejected"), ("doors are open", "rejected: doors are open")]
)
def test_a_refusal_is_told_with_the_reason_of_the_node(reason: str, told: str) -> None:
    core = _core()
    _configure(core)
    core.handle(NodeAnswer(1, BASE, False, reason), seconds(0.1))
    (step,) = core.change("c1").steps
    assert (step.status, step.error, step.ended_at) == (StepStatus.FAILED, told, seconds(0.1))
    assert core.change("c1").reason == f"drive_base: configure: {told}"


def test_an_acceptance_is_not_yet_an_end() -> None:
    core = _core()
    _configure(core)
    core.handle(NodeAnswer(1, BASE, True), seconds(0.1))
    assert core.change("c1").steps[0].status is StepStatus.RUNNING


def test_a_change_that_waits_for_a_node_fails_when_there_is_no_way_left() -> None:
    core = _core()
    _configure(core)
    core.handle(ModeRequest(BASE, SLOW), seconds(0.1))
    core.handle(NodeReport(BASE, state=LifecycleState.FINALIZED), seconds(0.2))
    change = core.change("c2")
    assert change.status is ChangeStatus.FAILED
    assert change.reason == "drive_base is finalized: no path to the goal"
    assert {step.status for step in change.steps[1:]} == {StepStatus.CANCELED}


def test_a_node_that_turns_out_to_have_no_lifecycle_cannot_be_configured() -> None:
    core = Supervision(actuation_model(), SupervisionSettings(), 0)
    _configure(core)
    core.handle(NodeReport(BASE, has_lifecycle=False), seconds(1))
    assert core.change("c1").reason == "drive_base has no lifecycle: no path to the goal"


def test_a_node_that_somebody_else_keeps_moving_is_given_up() -> None:
    core = _core()
    core.handle(ModeRequest(BASE, SLOW), 0)
    values: Parameters = {"max_speed": 0.2, "controller": "PID"}
    for _ in range(20):
        if core.change("c1").status is not ChangeStatus.RUNNING:
            break
        core.handle(NodeReport(BASE, state=LifecycleState.INACTIVE), 0)
        core.handle(NodeReport(BASE, state=LifecycleState.UNCONFIGURED, parameters={}), 0)
        core.handle(NodeReport(BASE, parameters=values), 0)
        core.handle(NodeReport(BASE, parameters={"max_speed": 0.3}), 0)
    change = core.change("c1")
    assert change.status is ChangeStatus.FAILED
    assert change.reason == "drive_base keeps leaving the requested state"


def test_a_step_that_times_out_ends_when_its_deadline_passes_and_is_told() -> None:
    core = _core()
    _configure(core)
    outputs = core.handle(TimePassed(), seconds(60))
    (step,) = core.change("c1").steps
    error = "not done within 10 s, and the node did not answer a query of its state"
    assert (step.status, step.ended_at, step.error) == (StepStatus.TIMED_OUT, seconds(11), error)
    assert core.change("c1").ended_at == seconds(11)
    (told,) = (dict(event.data) for event in outputs.events if event.kind == "change.step_ended")
    assert told == {
        "change": "c1",
        "node": "drive_base",
        "action": "configure",
        "status": "timed_out",
        "error": error,
    }


def test_a_step_of_a_node_that_is_gone_times_out_at_its_deadline() -> None:
    core = _core()
    _configure(core)
    core.handle(NodeReport(BASE, reachable=False), seconds(1))
    core.handle(TimePassed(), seconds(60))
    (step,) = core.change("c1").steps
    assert (step.status, step.ended_at) == (StepStatus.TIMED_OUT, seconds(10))
    assert step.error == "the node is unreachable"


def test_what_became_of_a_node_that_fell_silent_between_two_steps_is_not_known() -> None:
    core = _core()
    core.handle(TransitionRequest(BASE, Transition.ACTIVATE), 0)
    core.handle(NodeReport(BASE, state=LifecycleState.INACTIVE, reachable=False), seconds(1))
    core.handle(TimePassed(), seconds(60))
    change = core.change("c1")
    assert (change.status, change.reason) == (ChangeStatus.TIMED_OUT, f"{BASE} is unreachable")


def test_after_a_step_of_an_older_change_timed_out_the_newer_one_goes_on() -> None:
    core = _core()
    _configure(core)
    core.handle(TransitionRequest(BASE, Transition.SHUTDOWN), seconds(1))
    outputs = core.handle(TimePassed(), seconds(11))
    asked = [c for c in outputs.commands if isinstance(c, AskTransition)]
    assert asked == [AskTransition(3, BASE, Transition.SHUTDOWN)]
    assert core.change("c2").steps[0].started_at == seconds(11)


def test_a_node_that_is_never_heard_of_is_given_up_after_the_time_of_a_transition() -> None:
    core = Supervision(actuation_model(), SupervisionSettings(), 0)
    _configure(core)
    core.handle(TimePassed(), seconds(60))
    change = core.change("c1")
    assert (change.status, change.ended_at) == (ChangeStatus.FAILED, seconds(10))
    assert change.reason == "drive_base has never reported a state"


def test_a_node_that_stays_between_two_states_is_asked_once_and_then_given_up() -> None:
    core = Supervision(actuation_model(), SupervisionSettings(), 0)
    core.handle(NodeReport(BASE, state=LifecycleState.CONFIGURING), 0)
    core.handle(TransitionRequest(BASE, Transition.SHUTDOWN), 0)
    assert core.handle(TimePassed(), seconds(10)).commands[-1:] == (AskFacts(1, BASE),)
    core.handle(TimePassed(), seconds(60))
    change = core.change("c1")
    assert (change.status, change.ended_at) == (ChangeStatus.FAILED, seconds(11))
    assert change.reason == "drive_base is still configuring; no step was started"


def test_a_node_is_given_up_when_that_is_found_out() -> None:
    core = _core()
    _configure(core)
    core.handle(ModeRequest(BASE, SLOW), seconds(1))
    core.handle(NodeReport(BASE, state=LifecycleState.FINALIZED), seconds(2))
    change = core.change("c2")
    assert change.ended_at == seconds(2)
    error = "drive_base is finalized: no path to the goal"
    assert [(step.status, step.ended_at, step.error) for step in change.steps] == [
        (StepStatus.FAILED, seconds(2), error),
        (StepStatus.CANCELED, seconds(2), None),
        (StepStatus.CANCELED, seconds(2), None),
    ]
    assert core.wake_at() == seconds(2) + DEVIATES_AFTER, "no step has a deadline left"


def test_what_is_not_activated_under_estop_ends_then() -> None:
    core = _core()
    core.handle(NodeReport(BASE, state=LifecycleState.INACTIVE), 0)
    core.handle(EmergencyStopRequest(True, "smoke"), 0)
    core.handle(EmergencyStopRequest(False, "clear"), 0)
    core.handle(Readings(tuple(Reading(n, v) for n, v in GOOD.items()), "test"), seconds(1))
    core.handle(ModeRequest(BASE, SLOW), seconds(1))
    core.handle(EmergencyStopRequest(True, "smoke"), seconds(2))
    values: Parameters = {"max_speed": 0.2, "controller": "PID"}
    core.handle(NodeReport(BASE, parameters=values), seconds(2.5))
    change = core.change("c1")
    assert (change.status, change.ended_at) == (ChangeStatus.FAILED, seconds(2.5))
    assert change.steps[-1].error == "drive_base is not activated while ESTOP is active"


def test_after_a_refusal_the_newer_change_goes_on_at_once() -> None:
    core = _core()
    _configure(core)
    core.handle(TransitionRequest(BASE, Transition.SHUTDOWN), seconds(1))
    outputs = core.handle(NodeAnswer(1, BASE, False, "no"), seconds(2))
    assert outputs.commands == (AskTransition(2, BASE, Transition.SHUTDOWN),)
    assert core.change("c2").steps[0].started_at == seconds(2)


def test_a_step_that_ended_leaves_no_deadline() -> None:
    core = _core()
    _configure(core)
    core.handle(NodeReport(BASE, state=LifecycleState.INACTIVE), seconds(1))
    assert core.wake_at() is None


def test_parameters_are_asked_for_under_a_number_of_their_own() -> None:
    core = _core()
    outputs = core.handle(ParametersRequest(BASE, {"max_speed": 0.4}), 0)
    assert outputs.commands == (AskParameters(1, BASE, {"max_speed": 0.4}),)


def test_as_many_steps_as_are_allowed_are_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("domain.changes.node_steps._MAX_STEPS", 3)
    robot = CoreRobot(actuation_model())
    robot.read(**GOOD)
    change = robot.ask_mode("drive_base", "SLOW")
    robot.advance(2)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert len(robot.steps(change)) == 3
