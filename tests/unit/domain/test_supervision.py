"""The core: what one input leads to, and when."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import hypothesis.strategies as st
import pytest
from hypothesis import given, settings

from domain.actor import Actor
from domain.changes.admission import ADVISORY
from domain.commands import AskFacts, AskTransition, Command, Drive
from domain.computers import ComputerName, DeviceState
from domain.errors import (
    BackendUnavailableError,
    BlockedError,
    IllegalTransitionError,
    InvalidValueError,
    OutdatedReadingError,
    PilothouseError,
    UnknownChangeError,
    UnknownCheckpointError,
    UnknownErrorNameError,
    UnknownModeError,
    UnknownParameterError,
    UnknownPartError,
    UnknownSignalError,
)
from domain.events.event import RecordedEvent
from domain.health.signals import Recovery, default_signals
from domain.identifiers import ChangeId
from domain.inputs import (
    MAX_SHELF,
    AcknowledgeRequest,
    BackendStatus,
    CancelRequest,
    CheckpointReport,
    DeviceStatus,
    EmergencyStopRequest,
    GoalFeedback,
    GoalResult,
    HoldRequest,
    Input,
    ModeRequest,
    NodeAnswer,
    NodeReport,
    ParametersRequest,
    Reading,
    Readings,
    ShelveRequest,
    SignalValue,
    SourceFault,
    TimePassed,
    TransitionRequest,
    UnshelveRequest,
    VehicleReport,
    WriteRecord,
)
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outputs
from domain.simulation.node_settings import Fault, NodeSettings
from domain.snapshot import ChangeStatus, SystemState
from domain.state_and_mode import ModeName, PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import Instant, seconds
from domain.vehicle import DriveCommand, Point, Pose, VehicleState
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import ACTUATION, ARM, BASE, actuation_model, nested_model
from tests.support.scripted_robot import ScriptedRobot

S, T = LifecycleState, Transition
GRIPPER = PartName("gripper")
DOWN = BackendStatus(available=False, reason="no DDS")


def _core(start: Instant = 0) -> Supervision:
    return Supervision(actuation_model(), SupervisionSettings(), start)


def _readings(stamp: Instant | None = None, /, **values: SignalValue) -> Readings:
    return Readings(tuple(Reading(name, value, stamp) for name, value in values.items()), "test")


@pytest.fixture
def robot() -> CoreRobot:
    robot = CoreRobot(actuation_model())
    robot.read(**GOOD)
    return robot


def _seen(core: Supervision) -> object:
    """Return everything that can be seen of the robot."""
    return (
        dict(core.parts()),
        core.changes(),
        dict(core.signals()),
        core.system_state(),
        core.emergency_stop(),
        [core.parameters(node) for node in core.model.nodes],
        core.wake_at(),
    )


# --- refusals ------------------------------------------------------------------------------------

REFUSED: list[tuple[Input, type[PilothouseError]]] = [
    (NodeReport(GRIPPER, state=S.ACTIVE), UnknownPartError),
    (NodeReport(ACTUATION, state=S.ACTIVE), UnknownPartError),
    (CheckpointReport(GRIPPER, "cycle"), UnknownPartError),
    (CheckpointReport(BASE, "cycle"), UnknownCheckpointError),
    (_readings(speed=1.0), UnknownSignalError),
    (SourceFault("speed", "os", "no such file"), UnknownSignalError),
    (_readings(battery_level=0.1, temperature="hot"), InvalidValueError),
    (_readings(-seconds(9), temperature=20.0), OutdatedReadingError),
    (ModeRequest(GRIPPER, "FAST"), UnknownPartError),
    (ModeRequest(BASE, "NO_SUCH"), UnknownModeError),
    (TransitionRequest(BASE, T.DEACTIVATE), IllegalTransitionError),
    (ParametersRequest(BASE, {"speed": 1.0}), UnknownParameterError),
    (ParametersRequest(BASE, {"max_speed": 1}), InvalidValueError),
    (CancelRequest(ChangeId("c99")), UnknownChangeError),
    (AcknowledgeRequest("NO_SUCH"), UnknownErrorNameError),
    (AcknowledgeRequest("NO_SUCH", part=BASE), UnknownErrorNameError),
    (AcknowledgeRequest("DEVIATES", part=GRIPPER), UnknownPartError),
    (ShelveRequest("NO_SUCH", 1, "noise"), UnknownErrorNameError),
    (ShelveRequest("ESTOP", 0, "noise"), InvalidValueError),
    (ShelveRequest("ESTOP", MAX_SHELF + 1, "noise"), InvalidValueError),
    (ShelveRequest("ESTOP", 1, "  "), InvalidValueError),
    (UnshelveRequest("NO_SUCH"), UnknownErrorNameError),
    (DeviceStatus(ComputerName("leg"), DeviceState.LOST, "it is silent"), UnknownPartError),
]


@pytest.mark.parametrize(("given_", "error"), REFUSED, ids=lambda value: str(value)[:60])
def test_a_refused_input_changes_nothing_and_leaves_no_trace(
    robot: CoreRobot, given_: Input, error: type[PilothouseError]
) -> None:
    robot.give(_readings(robot.now, temperature=30.0))
    before = _seen(robot.core)
    with pytest.raises(error):
        robot.give(given_)
    assert _seen(robot.core) == before
    assert robot.give(TimePassed()) == Outputs()


@pytest.mark.parametrize(("given_", "error"), REFUSED, ids=lambda value: str(value)[:60])
def test_what_was_due_before_a_refused_input_is_delivered_with_the_next_call(
    robot: CoreRobot, given_: Input, error: type[PilothouseError]
) -> None:
    robot.give(_readings(robot.now, temperature=30.0))
    robot.ask_transition("drive_base", "configure")
    with pytest.raises(error):
        robot.core.handle(given_, seconds(10.5))
    outputs = robot.core.handle(TimePassed(), seconds(10.5))
    stale = [event for event in outputs.events if event.kind == "error.raised"]
    assert [event.at for event in stale] == [seconds(2) + 1]
    asked = [type(command) for command in outputs.commands if not isinstance(command, Drive)]
    assert asked == [AskFacts]


def test_what_follows_after_a_refusal_is_not_laid_to_the_one_who_was_refused(
    robot: CoreRobot,
) -> None:
    with pytest.raises(UnknownModeError):
        robot.give(ModeRequest(BASE, "NO_SUCH", actor=Actor("mallory")))
    outputs = robot.core.handle(TimePassed(), seconds(3))
    assert {event.actor.label for event in outputs.events} == {""}


def test_one_bad_reading_refuses_the_good_one_beside_it(robot: CoreRobot) -> None:
    with pytest.raises(InvalidValueError):
        robot.read(battery_level=0.1, temperature="hot")
    assert robot.core.signal("battery_level").value == 1.0


# --- time ----------------------------------------------------------------------------------------


def test_nothing_is_due_before_its_time_and_something_is_then(robot: CoreRobot) -> None:
    due = robot.core.wake_at()
    assert due is not None
    assert robot.core.handle(TimePassed(), due - 1) == Outputs()
    assert robot.core.handle(TimePassed(), due) != Outputs()


def test_the_nearest_deadline_is_next_whoever_sets_it(robot: CoreRobot) -> None:
    assert robot.core.wake_at() == seconds(0.3) + 1, "when the pose is too old"
    robot.core.handle(TimePassed(), seconds(0.3) + 1)
    assert robot.core.wake_at() == seconds(2) + 1, "when the readings are"
    robot.core.handle(_readings(**GOOD), seconds(0.5))
    robot.core.handle(ParametersRequest(BASE, {"max_speed": 0.4}), seconds(0.5))
    assert robot.core.wake_at() == seconds(2.5), "when the parameters should be set"


def test_without_readings_or_changes_nothing_is_due() -> None:
    assert _core().wake_at() is None


def test_deadlines_pass_in_order_each_at_its_own_time_however_late_the_call(
    robot: CoreRobot,
) -> None:
    """The arm is silent after its change, which fails; it deviates, and GPS is bad."""
    robot.core.handle(_readings(gps_accuracy=300.0), 0)
    robot.core.handle(TransitionRequest(ARM, T.CONFIGURE), 0)
    outputs = robot.core.handle(TimePassed(), seconds(3600))
    kinds = ("error.raised", "change.step_ended", "change.timed_out")
    assert [(event.at, event.kind) for event in outputs.events if event.kind in kinds] == [
        (seconds(2) + 1, "error.raised"),
        (seconds(11), "change.step_ended"),
        (seconds(11), "change.timed_out"),
        (seconds(11), "error.raised"),
        (seconds(12), "error.raised"),
        (seconds(15), "error.raised"),
    ]
    stop = Drive(DriveCommand(0.0, 0.0))
    assert outputs.commands == (stop, stop, AskFacts(2, ARM)), "no pose, then no readings"


def test_an_input_in_the_past_counts_as_now(robot: CoreRobot) -> None:
    robot.core.handle(TimePassed(), seconds(1))
    outputs = robot.core.handle(_readings(battery_level=0.1), seconds(0.4))
    assert {event.at for event in outputs.events} == {seconds(1)}
    assert robot.core.signal("battery_level").received_at == seconds(1)


# --- inputs and their causes ---------------------------------------------------------------------


def _root(events: Iterable[RecordedEvent], event: RecordedEvent) -> RecordedEvent:
    by_id = {other.id: other for other in events}
    while event.cause is not None:
        event = by_id[event.cause]
    return event


def _last(robot: CoreRobot, kind: str) -> RecordedEvent:
    return [event for event in robot.events if event.kind == kind][-1]


@pytest.mark.parametrize(
    ("fault", "kind", "root"),
    [
        (None, "change.succeeded", "change.requested"),
        (None, "part.deviation_ended", "change.requested"),
        (Fault.FAIL, "change.failed", "change.requested"),
        (Fault.ERROR, "change.failed", "change.requested"),
        (Fault.REFUSE, "change.failed", "change.requested"),
    ],
)
def test_how_a_change_ended_leads_back_to_who_asked_for_it(
    robot: CoreRobot, fault: Fault | None, kind: str, root: str
) -> None:
    robot.fault("drive_base", fault)
    robot.ask_transition("drive_base", "configure")
    robot.advance(1)
    assert _root(robot.events, _last(robot, kind)).kind == root


def test_what_a_node_does_on_its_own_has_no_cause(robot: CoreRobot) -> None:
    robot.give(NodeReport(BASE, state=S.ACTIVE))
    changed = _last(robot, "part.actual_changed")
    root = _root(robot.events, changed)
    assert (root.kind, root.cause) == ("node.reported", None)


@pytest.mark.parametrize(
    ("given_", "kind", "data"),
    [
        (
            NodeReport(BASE, S.ACTIVE, ModeName("FAST"), {"max_speed": 0.9}, reachable=True),
            "node.reported",
            {
                "node": "drive_base",
                "state": "active",
                "mode": "FAST",
                "parameters": {"max_speed": 0.9},
                "reachable": True,
            },
        ),
        (
            _readings(battery_level=0.1),
            "signal.read",
            {"source": "test", "values": {"battery_level": 0.1}},
        ),
        (
            ModeRequest(BASE, "FAST", Actor("alice")),
            "change.requested",
            {"part": "drive_base", "mode": "FAST"},
        ),
        (
            EmergencyStopRequest(True, "smoke", Actor("alice")),
            "emergency_stop.engaged",
            {"reason": "smoke"},
        ),
        (DOWN, "backend.unavailable", {"reason": "no DDS"}),
        (
            WriteRecord("PUT", "/holds/gate", 200, "10.0.0.7:4711", Actor("alice")),
            "audit.write",
            {"method": "PUT", "path": "/holds/gate", "status": 200, "address": "10.0.0.7:4711"},
        ),
        (
            HoldRequest("gate", "closed", Actor("alice")),
            "hold.requested",
            {"owner": "gate", "reason": "closed"},
        ),
    ],
    ids=["report", "reading", "change", "stop", "backend", "write", "hold"],
)
def test_an_input_that_matters_is_recorded_with_what_it_said(
    robot: CoreRobot, given_: Input, kind: str, data: Mapping[str, object]
) -> None:
    first = robot.give(given_).events[0]
    assert (first.kind, first.cause, dict(first.data)) == (kind, None, data)


def test_who_asked_is_told_with_everything_that_follows(robot: CoreRobot) -> None:
    outputs = robot.give(ModeRequest(BASE, "FAST", actor=Actor("alice")))
    assert len(outputs.events) > 1
    assert {event.actor.label for event in outputs.events} == {"alice"}


@pytest.mark.parametrize(
    "given_",
    [
        EmergencyStopRequest(True, "smoke", Actor("alice")),
        HoldRequest("gate", "closed", Actor("alice")),
        WriteRecord("PUT", "/holds/gate", 200, "10.0.0.7:4711", Actor("alice")),
        Readings((Reading("battery_level", 0.1),), "test", Actor("alice")),
        ParametersRequest(BASE, {"max_speed": 0.4}, Actor("alice")),
    ],
    ids=["stop", "hold", "write", "reading", "parameters"],
)
def test_whoever_did_something_is_told_with_it(robot: CoreRobot, given_: Input) -> None:
    assert {event.actor.label for event in robot.give(given_).events} == {"alice"}


def test_who_canceled_a_change_is_told(robot: CoreRobot) -> None:
    change = robot.ask_mode("drive_base", "FAST")
    outputs = robot.give(CancelRequest(change, actor=Actor("bob")))
    assert [(event.kind, event.actor.label) for event in outputs.events] == [
        ("change.cancel_requested", "bob"),
        ("change.canceled", "bob"),
    ]


def test_a_request_answers_with_its_change_and_the_commands_that_begin_it(
    robot: CoreRobot,
) -> None:
    outputs = robot.core.handle(TransitionRequest(BASE, T.CONFIGURE), 0)
    assert outputs.change == "c1"
    assert outputs.commands == (AskTransition(1, BASE, T.CONFIGURE),)
    assert outputs.parts == {BASE, ACTUATION}, "a system has not converged before its parts have"
    assert robot.core.changes()[0].status is ChangeStatus.RUNNING


def test_a_change_keeps_what_was_asked(robot: CoreRobot) -> None:
    request = ModeRequest(BASE, "FAST", Actor("alice"))
    robot.give(request)
    assert robot.core.changes()[0].request == request


def test_a_report_tells_whose_view_it_changed(robot: CoreRobot) -> None:
    assert robot.give(NodeReport(BASE, state=S.ACTIVE)).parts == {BASE, ACTUATION}


def test_a_refusal_is_recorded_with_what_the_node_said_and_leads_back_to_its_step(
    robot: CoreRobot,
) -> None:
    begun = robot.core.handle(TransitionRequest(BASE, T.CONFIGURE), 0)
    step = next(event for event in begun.events if event.kind == "change.step_started")
    refused = robot.core.handle(NodeAnswer(1, BASE, False, "doors are open"), 0).events[0]
    assert (refused.kind, refused.cause) == ("node.answered", step.id)
    assert dict(refused.data) == {
        "node": "drive_base",
        "accepted": False,
        "reason": "doors are open",
    }


def test_an_answer_to_something_else_is_of_no_account(robot: CoreRobot) -> None:
    robot.core.handle(TransitionRequest(BASE, T.CONFIGURE), 0)
    assert robot.core.handle(NodeAnswer(99, BASE, False, "no"), 0) == Outputs()
    assert robot.core.handle(NodeAnswer(1, ARM, False, "no"), 0) == Outputs()
    assert robot.core.changes()[0].status is ChangeStatus.RUNNING


# --- emergency stop and ESTOP --------------------------------------------------------------------


def test_the_emergency_stop_puts_the_robot_in_error_at_once(robot: CoreRobot) -> None:
    outputs = robot.stop()
    assert outputs.system_state
    assert robot.core.system_state().errors == ("ESTOP",)
    assert robot.core.emergency_stop().engaged


def test_who_engaged_and_who_released_the_stop_can_be_seen_and_is_told(
    robot: CoreRobot,
) -> None:
    robot.advance(0.1)
    robot.give(EmergencyStopRequest(True, "smoke", Actor("alice")))
    stop = robot.core.emergency_stop()
    assert (stop.by, stop.reason, stop.since) == ("alice", "smoke", seconds(0.1))
    robot.advance(0.1)
    (released, *_) = robot.give(EmergencyStopRequest(False, "all clear", Actor("bob"))).events
    assert (released.kind, released.actor.label) == ("emergency_stop.released", "bob")
    assert dict(released.data) == {"reason": "all clear"}
    stop = robot.core.emergency_stop()
    assert (stop.by, stop.reason, stop.since) == ("bob", "all clear", seconds(0.2))


def test_engaging_twice_keeps_who_did_it_first_and_tells_it_once(robot: CoreRobot) -> None:
    robot.stop()
    robot.advance(1)
    before = robot.core.emergency_stop()
    again = EmergencyStopRequest(True, "again", Actor("somebody else"))
    assert robot.core.handle(again, robot.now) == Outputs()
    assert robot.core.emergency_stop() is before


def test_releasing_what_is_not_engaged_is_harmless(robot: CoreRobot) -> None:
    assert robot.release_stop() == Outputs()


def test_no_reading_releases_the_emergency_stop(robot: CoreRobot) -> None:
    robot.stop()
    robot.advance(1)
    robot.read(**GOOD)
    assert robot.core.system_state().errors == ("ESTOP",)
    robot.release_stop()
    assert robot.core.system_state().state is SystemState.IDLE


@pytest.mark.parametrize("by_reading", [True, False])
def test_under_estop_the_modes_that_are_shown_as_blocked_are_refused_for_that_and_no_others(
    robot: CoreRobot, *, by_reading: bool
) -> None:
    robot.ask_transition("drive_base", "activate")
    robot.advance(1)
    if by_reading:
        robot.read(estop=True)
    else:
        robot.stop()
    seen = {}
    for part in robot.model.parts:
        for view in robot.core.modes(part):
            seen[f"{part}.{view.mode}"] = view.can_enter
            if view.can_enter:
                robot.core.plan(ModeRequest(part, view.mode))
                continue
            with pytest.raises(BlockedError) as refusal:
                robot.core.plan(ModeRequest(part, view.mode))
            assert refusal.value.blockers == view.blockers
            assert {blocker.code for blocker in view.blockers} == {"ESTOP"}
    assert seen == {
        "actuation.__DEFAULT__": True,
        "actuation.MODERATE": False,
        "actuation.PERFORMANCE": False,
        "drive_base.__DEFAULT__": True,
        "drive_base.SLOW": True,
        "drive_base.FAST": True,
        "manipulator.__DEFAULT__": False,
        "manipulator.WEAK": False,
        "manipulator.STRONG": False,
    }


def test_when_estop_ends_modes_can_be_entered_again(robot: CoreRobot) -> None:
    robot.stop()
    robot.advance(1)
    robot.read(**GOOD)
    robot.release_stop()
    assert all(view.can_enter for view in robot.core.modes(ACTUATION))


def test_under_estop_activate_is_not_available(robot: CoreRobot) -> None:
    assert T.ACTIVATE in robot.core.available_transitions(BASE)
    robot.stop()
    assert T.ACTIVATE not in robot.core.available_transitions(BASE)


def test_in_error_without_estop_changes_stay_possible(robot: CoreRobot) -> None:
    robot.read(battery_level=0.1)
    change = robot.ask_mode("drive_base", "FAST")
    robot.advance(1)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED


def test_acknowledging_what_is_not_on_changes_nothing(robot: CoreRobot) -> None:
    assert robot.give(AcknowledgeRequest("ESTOP")) == Outputs()


# --- the vehicle and its task --------------------------------------------------------------------


def _standing(x_m: float, speed_mps: float) -> VehicleReport:
    return VehicleReport(VehicleState(Pose(x_m, 2.0, 0.0), speed_mps, 0.0))


def test_a_report_of_the_vehicle_is_recorded_with_where_it_is_once_something_follows() -> None:
    core = _core()
    outputs = core.handle(_standing(1.0, 0.5), seconds(1))
    assert [event.kind for event in outputs.events] == ["vehicle.reported", "hold.released"]
    assert dict(outputs.events[0].data) == {"x_m": 1.0, "y_m": 2.0, "speed_mps": 0.5}
    assert core.handle(_standing(1.1, 0.5), seconds(1.05)).events == ()


def test_that_the_vehicle_stands_after_an_emergency_stop_is_told_once() -> None:
    core = _core()
    core.handle(EmergencyStopRequest(True, "smoke", Actor("alice")), 0)
    assert core.handle(_standing(0.0, 1.0), seconds(0.1)).events[-1].kind == "hold.released"
    told = core.handle(_standing(0.1, 0.0), seconds(0.2)).events
    assert [event.kind for event in told] == ["vehicle.reported", "emergency_stop.standstill"]
    assert core.emergency_stop().standstill_at == seconds(0.2)
    assert core.handle(_standing(0.1, 0.0), seconds(0.3)).events == ()


def test_a_vehicle_that_stands_without_a_stop_tells_nothing_of_one() -> None:
    core = _core()
    told = core.handle(_standing(0.0, 0.0), seconds(0.1)).events
    assert "emergency_stop.standstill" not in [event.kind for event in told]
    assert core.emergency_stop().standstill_at is None


def test_what_navigation_says_is_recorded_when_it_ends_the_task() -> None:
    robot = ScriptedRobot()
    robot.submit_task()
    command, ahead = DriveCommand(2.8, 0.0), Point(5.0, 0.0)
    driven = robot.give(GoalFeedback(robot.goals[0].goal, 3, 2.5, 0.0, ahead, command))
    assert driven.events == ()
    assert driven.task_changed
    ended = robot.give(GoalResult(robot.goals[0].goal, False, "no progress for 20 s"))
    assert [event.kind for event in ended.events] == [
        "goal.ended",
        "task.aborted",
        "system_state.changed",
    ]
    assert dict(ended.events[0].data) == {
        "goal": 1,
        "succeeded": False,
        "reason": "no progress for 20 s",
    }
    assert ended.events[1].cause == ended.events[0].id


def test_a_task_that_begins_or_ends_changes_the_state_of_the_robot() -> None:
    robot = ScriptedRobot()
    served = robot.submit_task()
    assert served.system_state
    assert served.task == "t1"
    assert robot.happened("system_state.changed")[-1]["state"] == "RUNNING"
    robot.cancel_task()
    assert robot.happened("system_state.changed")[-1]["state"] == "IDLE"


# --- backend -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "request_",
    [
        ModeRequest(BASE, "FAST"),
        TransitionRequest(BASE, T.CONFIGURE),
        ParametersRequest(BASE, {"max_speed": 0.4}),
    ],
    ids=str,
)
def test_without_a_backend_no_change_begins(
    robot: CoreRobot, request_: ModeRequest | TransitionRequest | ParametersRequest
) -> None:
    robot.give(DOWN)
    before = _seen(robot.core)
    with pytest.raises(BackendUnavailableError, match="no DDS"):
        robot.give(request_)
    assert _seen(robot.core) == before


def test_without_a_backend_a_dry_run_is_refused_as_the_request_is(robot: CoreRobot) -> None:
    robot.give(DOWN)
    with pytest.raises(BackendUnavailableError):
        robot.core.plan(ModeRequest(BASE, "FAST"))


def test_without_a_backend_what_does_not_exist_still_does_not_exist(robot: CoreRobot) -> None:
    robot.give(DOWN)
    with pytest.raises(UnknownModeError):
        robot.give(ModeRequest(BASE, "NO_SUCH"))


def test_without_a_backend_health_is_still_judged(robot: CoreRobot) -> None:
    robot.give(DOWN)
    robot.read(battery_level=0.1)
    assert robot.core.system_state().errors == ("BATTERY_LOW",)


def test_a_backend_that_is_back_is_told_and_takes_requests(robot: CoreRobot) -> None:
    robot.give(DOWN)
    outputs = robot.give(BackendStatus(available=True))
    assert [event.kind for event in outputs.events] == ["backend.available"]
    robot.ask_mode("drive_base", "FAST")


def test_a_backend_that_stays_down_is_told_once_and_its_newest_reason_counts(
    robot: CoreRobot,
) -> None:
    robot.give(DOWN)
    assert robot.give(BackendStatus(available=False, reason="still no DDS")) == Outputs()
    with pytest.raises(BackendUnavailableError, match="still no DDS"):
        robot.give(ModeRequest(BASE, "FAST"))


# --- dry runs ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "request_",
    [
        ModeRequest(ACTUATION, "PERFORMANCE"),
        TransitionRequest(ACTUATION, T.ACTIVATE),
        TransitionRequest(BASE, T.SHUTDOWN),
        ParametersRequest(BASE, {"max_speed": 0.4}),
    ],
    ids=str,
)
def test_a_dry_run_shows_the_steps_that_the_change_takes_and_changes_nothing(
    robot: CoreRobot, request_: ModeRequest | TransitionRequest | ParametersRequest
) -> None:
    before = _seen(robot.core)
    planned = [(step.node, str(step.action)) for step in robot.core.plan(request_).steps]
    assert _seen(robot.core) == before
    change = robot.give(request_).change
    assert change is not None
    robot.advance(3)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert planned == [(step.node, str(step.action)) for step in robot.change(change).steps]


def test_a_dry_run_is_refused_as_the_request_would_be(robot: CoreRobot) -> None:
    with pytest.raises(IllegalTransitionError):
        robot.core.plan(TransitionRequest(BASE, T.DEACTIVATE))
    with pytest.raises(UnknownModeError):
        robot.core.plan(ModeRequest(BASE, "NO_SUCH"))


def test_of_a_node_that_is_not_heard_of_the_last_step_is_shown() -> None:
    steps = _core().plan(TransitionRequest(BASE, T.ACTIVATE)).steps
    assert [(step.node, step.action) for step in steps] == [(BASE, T.ACTIVATE)]


# --- determinism ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Given:
    """One input, and how long after the one before."""

    after_ms: int
    given: Input


@dataclass
class Run:
    """All that came out of one core."""

    core: Supervision
    events: tuple[RecordedEvent, ...] = ()
    commands: tuple[Command, ...] = ()
    refusals: tuple[str, ...] = ()

    def hand(self, given: Input, now: Instant) -> None:
        try:
            outputs = self.core.handle(given, now)
        except PilothouseError as refusal:
            self.refusals += (refusal.message,)
            return
        self.events += outputs.events
        self.commands += outputs.commands


MODEL = nested_model()
NODES, PARTS = st.sampled_from(list(MODEL.nodes)), st.sampled_from(MODEL.parts)
MODES = st.sampled_from(["__DEFAULT__", "FAST", "STRONG", "PERFORMANCE", "RACE", "PARKED"])
INPUTS: st.SearchStrategy[Input] = st.one_of(
    st.builds(NodeReport, NODES, state=st.sampled_from(list(S)[1:])),
    st.builds(
        NodeReport,
        NODES,
        parameters=st.fixed_dictionaries({"max_speed": st.sampled_from([0.1, 0.9])}),
        reachable=st.none() | st.booleans(),
    ),
    st.builds(NodeAnswer, st.integers(1, 12), NODES, st.just(False), st.just("no")),
    st.builds(ModeRequest, PARTS, MODES),
    st.builds(TransitionRequest, PARTS, st.sampled_from(T)),
    st.builds(CancelRequest, st.builds(lambda n: ChangeId(f"c{n}"), st.integers(1, 5))),
    st.builds(EmergencyStopRequest, st.booleans(), st.just("test")),
    st.builds(
        lambda **values: _readings(**{**GOOD, **values}),
        gps_accuracy=st.sampled_from([100.0, 300.0]),
        estop=st.booleans(),
        signal_strength=st.sampled_from(["CONNECTED", "LOW_SIGNAL", "NOT_CONNECTED"]),
    ),
)
SCRIPTS = st.lists(
    st.builds(Given, st.sampled_from([0, 1, 100, 200, 1_000, 2_000, 2_001, 10_000]), INPUTS),
    min_size=1,
    max_size=25,
)


def _run(
    script: list[Given],
    start: Instant = 0,
    extra_ms: Iterable[int] = (),
    extra: Input = TimePassed(),  # noqa: B008
) -> Run:
    """Hand in a script, and besides `extra` at each of `extra_ms` after the start."""
    run = Run(Supervision(MODEL, SupervisionSettings(), start))
    inputs: list[tuple[int, int, Input]] = []
    at = 0
    for number, step in enumerate(script):
        at += step.after_ms
        inputs.append((at, number, step.given))
    end = at + 30_000
    inputs += [(at_ms, -1, extra) for at_ms in extra_ms if at_ms <= end]
    for at_ms, _, given_ in sorted(inputs, key=lambda item: item[:2]):
        run.hand(given_, start + at_ms * 1_000_000)
    run.hand(TimePassed(), start + end * 1_000_000)
    return run


@given(SCRIPTS)
@settings(max_examples=60)
def test_the_same_inputs_at_the_same_times_give_the_same_outputs_byte_for_byte(
    script: list[Given],
) -> None:
    one, other = _run(script), _run(script)
    assert repr((one.events, one.commands)) == repr((other.events, other.commands))
    assert one.refusals == other.refusals


@given(SCRIPTS, st.lists(st.integers(0, 60_000), max_size=40))
def test_one_big_step_equals_many_small_ones(script: list[Given], extra_ms: list[int]) -> None:
    big, small = _run(script), _run(script, extra_ms=extra_ms)
    assert small.events == big.events
    assert small.commands == big.commands
    assert small.refusals == big.refusals
    assert _seen(small.core) == _seen(big.core)


@given(SCRIPTS, st.lists(st.integers(0, 60_000), max_size=40))
@settings(max_examples=60)
def test_nothing_follows_from_the_record_of_a_request(
    script: list[Given], extra_ms: list[int]
) -> None:
    record = WriteRecord("PUT", "/holds/gate", 200, "10.0.0.7:4711")
    bare, recorded = _run(script), _run(script, extra_ms=extra_ms, extra=record)
    others = [event for event in recorded.events if event.data.get("path") != record.path]
    assert [(event.at, event.kind) for event in others] == [
        (event.at, event.kind) for event in bare.events
    ]
    assert recorded.commands == bare.commands
    assert recorded.refusals == bare.refusals
    # Events have other ids, and so have causes.
    one, other = bare.core, recorded.core
    assert dict(other.parts()) == dict(one.parts())
    assert (other.system_state(), other.wake_at()) == (one.system_state(), one.wake_at())


@given(SCRIPTS, st.sampled_from([seconds(1), seconds(86_400 * 365)]))
@settings(max_examples=60)
def test_only_differences_of_time_mean_anything(script: list[Given], start: Instant) -> None:
    here, later = _run(script), _run(script, start)
    assert [replace(event, at=event.at - start) for event in later.events] == list(here.events)
    assert later.commands == here.commands
    for one, other in zip(here.core.changes(), later.core.changes(), strict=True):
        assert [(s.status, s.error) for s in one.steps] == [
            (s.status, s.error) for s in other.steps
        ]


@given(SCRIPTS)
@settings(max_examples=60)
def test_it_wakes_exactly_when_something_happens(script: list[Given]) -> None:
    run = _run(script)
    core = run.core
    for _ in range(20):
        due = core.wake_at()
        if due is None:
            return
        assert core.handle(TimePassed(), due - 1) == Outputs()
        assert core.handle(TimePassed(), due) != Outputs()


@pytest.mark.parametrize("start_s", [0, 5])
def test_steps_that_are_not_reached_are_canceled_at_any_time_of_the_clock(start_s: float) -> None:
    refusing = {"manipulator": NodeSettings(fault=Fault.REFUSE)}
    robot = CoreRobot(actuation_model(), nodes=refusing, start=seconds(start_s))
    robot.read(**GOOD)
    change = robot.ask_mode("manipulator", "STRONG")
    robot.advance(1)
    assert [status for _, _, status in robot.steps(change)] == ["failed", "canceled", "canceled"]


# --- what can be seen ----------------------------------------------------------------------------


def test_a_robot_of_which_nothing_was_read_is_in_error() -> None:
    """Unknown is not good."""
    state = _core().system_state()
    assert (state.state, state.errors) == (SystemState.ERROR, ("STALE_DATA",))


def test_what_is_not_there_is_told(robot: CoreRobot) -> None:
    with pytest.raises(UnknownChangeError):
        robot.core.change("c99")
    with pytest.raises(UnknownSignalError):
        robot.core.signal("speed")


def test_a_part_is_shown_with_the_change_that_it_is_under(robot: CoreRobot) -> None:
    change = robot.ask_mode("drive_base", "FAST")
    assert robot.core.part(BASE).change == change
    assert robot.core.part(ARM).change is None
    assert robot.core.part(BASE) is robot.core.parts()[BASE]


def test_changes_are_shown_newest_first(robot: CoreRobot) -> None:
    older, newer = robot.ask_mode("drive_base", "FAST"), robot.ask_mode("manipulator", "WEAK")
    assert [change.id for change in robot.core.changes()] == [newer, older]


def test_an_absent_node_is_shown_among_the_blockers_and_refuses_nothing() -> None:
    core = _core()
    (view, *_) = core.modes(BASE)
    assert view.can_enter
    assert {blocker.code for blocker in view.blockers} <= ADVISORY
    assert not any(blocker.refuses for blocker in view.blockers)
    assert core.handle(ModeRequest(BASE, view.mode), 0).change is not None


def test_what_time_alone_leads_to_is_laid_to_time(robot: CoreRobot) -> None:
    outputs = robot.core.handle(TimePassed(), seconds(3))
    first = outputs.events[0]
    assert (first.kind, dict(first.data), first.cause) == ("time.passed", {}, None)


def test_acknowledging_what_is_on_is_recorded_with_who_did_it() -> None:
    signals = [
        replace(item, recovery=Recovery.ACKNOWLEDGE, stale_after=0) for item in default_signals()
    ]
    core = Supervision(actuation_model(), SupervisionSettings(signals=tuple(signals)), 0)
    core.handle(_readings(battery_level=0.1), 0)
    core.handle(_readings(battery_level=0.9), seconds(1))
    events = core.handle(AcknowledgeRequest("BATTERY_LOW", Actor("alice")), seconds(2)).events
    assert [(event.kind, event.actor.label) for event in events[:2]] == [
        ("error.acknowledged", "alice"),
        ("error.cleared", "alice"),
    ]
    assert dict(events[0].data) == {"error": "BATTERY_LOW", "part": None}


def test_a_deviation_counts_from_the_input_that_began_it(robot: CoreRobot) -> None:
    robot.core.handle(ModeRequest(BASE, "FAST"), seconds(0.2))
    assert robot.core.part(BASE).deviation_since == seconds(0.2)


def test_the_state_that_follows_an_error_is_laid_to_the_error(robot: CoreRobot) -> None:
    events = robot.give(_readings(battery_level=0.1)).events
    (raised,) = (event for event in events if event.kind == "error.raised")
    (changed,) = (event for event in events if event.kind == "system_state.changed")
    assert changed.cause == raised.id
