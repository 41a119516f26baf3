"""What is wrong with parts, as an operator finds it in the list of errors."""

import pytest

from domain.events.event import RecordedEvent
from domain.findings import Blocker
from domain.health.error_list import ErrorList
from domain.health.part_errors import DEVIATES_AFTER, LOOKS_AT_ONCE, PartErrors
from domain.inputs import ModeRequest, NodeReport, ParametersRequest, Restored, TimePassed
from domain.kept import Keeping, Kept, KeptChange, KeptFailedChange, KeptTarget
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault
from domain.snapshot import ErrorKey, ErrorState, ErrorView, SystemState
from domain.state_and_mode import ModeName, PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.big_model import big_model
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    FAST,
    PERFORMANCE,
    STRONG,
    active,
    actuation_model,
    nested_model,
)

S = ErrorState


class Robot(CoreRobot):
    """A simulated robot, with the questions that these stories ask."""

    def error(self, part: str, error: str) -> ErrorView:
        return self.core.error(ErrorKey(PartName(part), error))

    def on(self, part: str) -> list[str]:
        views = self.core.errors_of(PartName(part))
        return [view.key.error for view in views if view.state.is_on]

    def told(self, error: str) -> list[tuple[str, str]]:
        """Return kind and part of all events of an error."""
        return [
            (event.kind, str(event.data["part"]))
            for event in self.events
            if event.kind in ("error.raised", "error.cleared") and event.data["error"] == error
        ]


@pytest.fixture
def robot() -> Robot:
    """Return a robot whose nodes are heard and unconfigured."""
    return Robot(actuation_model())


def test_a_robot_that_works_has_no_errors_of_parts(robot: Robot) -> None:
    robot.ask_mode(ACTUATION, "PERFORMANCE")
    robot.advance(10)
    assert [name for name in robot.core.open_errors() if "." in name] == []
    assert [e.data for e in robot.events if e.kind == "error.raised"] == []


# --- UNREACHABLE ---------------------------------------------------------------------------------


def test_a_node_that_dies_is_unreachable_until_it_is_back(robot: Robot) -> None:
    robot.advance(3)
    robot.fault(BASE, Fault.DIE)
    robot.advance(5)
    lost = robot.error(BASE, "UNREACHABLE")
    assert (lost.state, lost.severity, lost.count) == (S.ACTIVE, "urgent", 1)
    assert lost.message == "drive_base is unreachable"
    assert not robot.core.part(BASE).reachable
    robot.fault(BASE, None)
    robot.advance(5)
    assert robot.on(BASE) == []
    assert robot.told("UNREACHABLE") == [("error.raised", BASE), ("error.cleared", BASE)]


def test_a_node_that_was_never_heard_of_is_unreachable_since_the_start() -> None:
    core = Supervision(actuation_model(), SupervisionSettings(), seconds(7))
    view = core.error(ErrorKey(BASE, "UNREACHABLE"))
    assert (view.state, view.since) == (S.ACTIVE, seconds(7))
    assert view.message == "drive_base was never heard of"


def test_that_a_node_is_heard_for_the_first_time_is_not_the_end_of_a_told_error() -> None:
    core = Supervision(actuation_model(), SupervisionSettings(), 0)
    outputs = core.handle(NodeReport(BASE, reachable=True), seconds(1))
    assert [event.kind for event in outputs.events if event.kind.startswith("error")] == []
    assert ErrorKey(BASE, "UNREACHABLE") in outputs.errors
    assert core.error(ErrorKey(BASE, "UNREACHABLE")).state is S.NORMAL


# --- ERROR_PROCESSING ----------------------------------------------------------------------------


def test_a_node_in_errorprocessing_has_the_error_until_it_leaves(robot: Robot) -> None:
    robot.give(NodeReport(BASE, state=LifecycleState.ERROR_PROCESSING))
    bad = robot.error(BASE, "ERROR_PROCESSING")
    assert (bad.state, bad.severity) == (S.ACTIVE, "urgent")
    assert bad.message == "drive_base is in errorprocessing"
    robot.give(NodeReport(BASE, state=LifecycleState.UNCONFIGURED))
    assert robot.told("ERROR_PROCESSING") == [("error.raised", BASE), ("error.cleared", BASE)]


# --- PARAMETERS_DRIFTED --------------------------------------------------------------------------


def test_parameters_that_somebody_else_sets_have_drifted(robot: Robot) -> None:
    robot.ask_mode(BASE, "FAST")
    robot.advance(10)
    robot.nodes.set_parameters(BASE, {"max_speed": 0.4}, robot.now)
    robot.advance(0.1)
    drift = robot.error(BASE, "PARAMETERS_DRIFTED")
    assert (drift.state, drift.value, drift.threshold) == (S.ACTIVE, 0.4, 0.9)
    assert drift.message == "max_speed is 0.4, FAST requires 0.9"
    robot.nodes.set_parameters(BASE, {"max_speed": 0.9}, robot.now)
    robot.advance(0.1)
    assert robot.told("PARAMETERS_DRIFTED") == [("error.raised", BASE), ("error.cleared", BASE)]


def test_parameters_have_not_drifted_while_a_change_sets_them(robot: Robot) -> None:
    robot.ask_mode(BASE, "FAST")
    robot.advance(10)
    robot.ask_mode(BASE, "SLOW")
    robot.advance(10)
    assert robot.told("PARAMETERS_DRIFTED") == []


def test_parameters_set_on_purpose_differ_from_the_target_mode_all_the_same(robot: Robot) -> None:
    robot.ask_mode(BASE, "FAST")
    robot.advance(10)
    robot.begin(ParametersRequest(BASE, {"max_speed": 0.4}))
    robot.advance(1)
    assert robot.on(BASE)[0] == "PARAMETERS_DRIFTED"


def test_a_node_that_is_not_active_has_no_parameters_to_keep(robot: Robot) -> None:
    robot.ask_mode(BASE, "FAST")
    robot.advance(10)
    robot.nodes.set_parameters(BASE, {"max_speed": 0.4}, robot.now)
    robot.advance(0.1)
    robot.give(NodeReport(BASE, state=LifecycleState.INACTIVE))
    assert "PARAMETERS_DRIFTED" not in robot.on(BASE)


# --- DEVIATES ------------------------------------------------------------------------------------


def test_a_deviation_is_pending_for_a_second_and_then_an_error(robot: Robot) -> None:
    robot.ask_mode(BASE, "FAST")
    robot.advance(10)
    began = robot.now
    robot.give(NodeReport(BASE, state=LifecycleState.INACTIVE))
    pending = robot.error(BASE, "DEVIATES")
    assert (pending.state, pending.since, pending.count) == (S.PENDING, began, 0)
    robot.advance(0.999)
    assert robot.on(BASE) == []
    robot.advance(0.001)
    deviates = robot.error(BASE, "DEVIATES")
    assert (deviates.state, deviates.since) == (S.ACTIVE, began + DEVIATES_AFTER)
    assert (deviates.value, deviates.threshold) == ("inactive", "active.FAST")
    assert deviates.message == "drive_base is inactive, target active.FAST"


def test_a_short_deviation_is_no_error(robot: Robot) -> None:
    robot.ask_mode(BASE, "FAST")
    robot.advance(10)
    robot.give(NodeReport(BASE, state=LifecycleState.INACTIVE))
    robot.advance(0.9)
    robot.give(NodeReport(BASE, state=LifecycleState.ACTIVE))
    robot.advance(5)
    assert robot.told("DEVIATES") == []
    assert robot.error(BASE, "DEVIATES").state is S.NORMAL


def test_a_deviation_is_laid_to_the_input_that_began_it(robot: Robot) -> None:
    robot.ask_mode(BASE, "FAST")
    robot.advance(10)
    robot.give(NodeReport(BASE, state=LifecycleState.INACTIVE))
    robot.advance(2)
    (raised,) = (e for e in robot.events if e.kind == "error.raised" and e.data["part"] == BASE)
    (cause,) = (e for e in robot.events if e.id == raised.cause)
    assert (cause.kind, cause.data["state"]) == ("node.reported", "inactive")


def test_while_a_change_drives_a_part_it_does_not_deviate() -> None:
    robot = Robot(actuation_model())
    robot.fault(BASE, Fault.SILENT)
    change = robot.ask_mode(ACTUATION, "PERFORMANCE")
    robot.advance(9)
    assert robot.change(change).status == "running"
    assert robot.told("DEVIATES") == []
    robot.advance(5)
    assert robot.change(change).status == "timed_out"
    assert set(robot.told("DEVIATES")) == {("error.raised", ACTUATION), ("error.raised", BASE)}


def test_a_new_request_ends_the_deviation_that_it_mends(robot: Robot) -> None:
    robot.ask_mode(BASE, "FAST")
    robot.advance(10)
    robot.nodes.set_parameters(BASE, {"max_speed": 0.2, "controller": "PID"}, robot.now)
    robot.advance(2)
    assert robot.on(BASE) == ["PARAMETERS_DRIFTED", "DEVIATES"]
    robot.ask_mode(BASE, "FAST")
    assert robot.on(BASE) == []
    robot.advance(10)
    assert robot.on(BASE) == []


def test_a_system_deviates_because_of_a_part_below_it(robot: Robot) -> None:
    robot.ask_mode(ACTUATION, "PERFORMANCE")
    robot.advance(10)
    robot.give(NodeReport(BASE, state=LifecycleState.INACTIVE))
    robot.advance(2)
    assert robot.on(ACTUATION) == ["DEVIATES"]
    assert robot.error(ACTUATION, "DEVIATES").message.startswith("drive_base is inactive")
    robot.give(NodeReport(BASE, state=LifecycleState.ACTIVE))
    assert robot.on(ACTUATION) == robot.on(BASE) == []


def test_a_system_does_not_deviate_while_a_change_works_on_the_part_that_is_why() -> None:
    robot = Robot(nested_model())
    robot.ask_mode("robot", "RACE")
    robot.advance(20)
    robot.fault(BASE, Fault.SLOW)
    robot.ask_transition(BASE, "deactivate")
    robot.ask_mode(BASE, "FAST")
    robot.advance(1.5)
    assert robot.core.part(BASE).change is not None
    assert robot.told("DEVIATES") == []


def test_a_part_changed_on_purpose_leaves_its_system_behind(robot: Robot) -> None:
    robot.ask_mode(ACTUATION, "PERFORMANCE")
    robot.advance(10)
    robot.ask_mode(BASE, "SLOW")
    robot.advance(5)
    assert (robot.on(BASE), robot.on(ACTUATION)) == ([], ["DEVIATES"])


def test_a_part_of_which_nothing_was_asked_does_not_deviate(robot: Robot) -> None:
    robot.fault(BASE, Fault.DIE)
    robot.advance(10)
    assert robot.on(BASE) == ["UNREACHABLE"]
    assert robot.on(ACTUATION) == []


# --- CHANGE_FAILED -------------------------------------------------------------------------------


def test_a_change_that_failed_is_an_error_until_the_next_success(robot: Robot) -> None:
    robot.fault(BASE, Fault.REFUSE)
    failed = robot.ask_transition(BASE, "configure")
    robot.advance(1)
    error = robot.error(BASE, "CHANGE_FAILED")
    assert (error.state, error.value) == (S.ACTIVE, "failed")
    assert error.message.startswith(f"change {failed} failed: drive_base: configure: ")
    robot.fault(BASE, None)
    robot.ask_transition(BASE, "configure")
    assert "CHANGE_FAILED" in robot.on(BASE), "it has not succeeded yet"
    robot.advance(2)
    assert robot.told("CHANGE_FAILED") == [("error.raised", BASE), ("error.cleared", BASE)]


def test_a_change_that_timed_out_is_an_error_of_the_requested_part_alone(robot: Robot) -> None:
    robot.fault(BASE, Fault.SILENT)
    robot.ask_mode(ACTUATION, "PERFORMANCE")
    robot.advance(15)
    assert "CHANGE_FAILED" in robot.on(ACTUATION)
    assert "CHANGE_FAILED" not in robot.on(BASE)
    assert robot.error(ACTUATION, "CHANGE_FAILED").value == "timed_out"


def test_a_change_that_failed_for_want_of_a_node_follows_from_its_loss(robot: Robot) -> None:
    robot.fault(BASE, Fault.SILENT)
    robot.ask_mode(ACTUATION, "PERFORMANCE")
    robot.advance(15)
    error = robot.error(ACTUATION, "CHANGE_FAILED")
    assert error.roots == (ErrorKey(BASE, "UNREACHABLE"),)
    raised = [e for e in robot.events if e.kind == "error.raised" and e.data["root_cause"]]
    assert [(e.data["part"], e.data["error"]) for e in raised] == [(BASE, "UNREACHABLE")]


def test_a_change_that_failed_for_another_reason_as_well_follows_from_nothing(
    robot: Robot,
) -> None:
    robot.fault(BASE, Fault.SILENT)
    robot.fault(ARM, Fault.REFUSE)
    robot.ask_mode(ACTUATION, "PERFORMANCE")
    robot.advance(15)
    assert robot.error(ACTUATION, "CHANGE_FAILED").roots == ()


def test_a_second_failure_has_the_causes_of_its_own(robot: Robot) -> None:
    robot.fault(BASE, Fault.SILENT)
    robot.ask_mode(ACTUATION, "PERFORMANCE")
    robot.advance(15)
    robot.fault(BASE, None)
    robot.advance(5)
    kept = robot.error(ACTUATION, "CHANGE_FAILED")
    assert kept.roots == (ErrorKey(BASE, "UNREACHABLE"),), "it keeps its root until it is over"
    robot.fault(ARM, Fault.REFUSE)
    robot.ask_transition(ACTUATION, "cleanup")
    robot.advance(15)
    assert robot.error(ACTUATION, "CHANGE_FAILED").roots == ()


def test_a_second_failure_says_what_failed_last_and_is_not_told_twice(robot: Robot) -> None:
    robot.fault(BASE, Fault.REFUSE)
    robot.ask_transition(BASE, "configure")
    robot.advance(1)
    since = robot.error(BASE, "CHANGE_FAILED").since
    second = robot.ask_mode(BASE, "FAST")
    robot.advance(1)
    error = robot.error(BASE, "CHANGE_FAILED")
    assert error.message.startswith(f"change {second} failed")
    assert (error.since, error.count) == (since, 1)
    assert robot.told("CHANGE_FAILED") == [("error.raised", BASE)]


def test_a_change_of_the_system_that_succeeds_proves_the_part_well(robot: Robot) -> None:
    robot.fault(BASE, Fault.REFUSE)
    robot.ask_mode(BASE, "FAST")
    robot.advance(1)
    robot.fault(BASE, None)
    robot.ask_mode(ACTUATION, "PERFORMANCE")
    robot.advance(10)
    assert robot.on(BASE) == []


def test_a_superseded_or_canceled_change_has_not_failed(robot: Robot) -> None:
    robot.ask_mode(BASE, "FAST")
    robot.advance(0.1)
    robot.ask_mode(BASE, "SLOW")
    robot.advance(10)
    assert robot.told("CHANGE_FAILED") == []


def test_a_failed_change_is_laid_to_its_end(robot: Robot) -> None:
    robot.fault(BASE, Fault.REFUSE)
    robot.ask_transition(BASE, "configure")
    robot.advance(0.5)
    (raised,) = (e for e in robot.events if e.kind == "error.raised" and e.data["part"] == BASE)
    (ended,) = (e for e in robot.events if e.kind == "change.failed")
    assert raised.cause == ended.id


# --- over a restart ------------------------------------------------------------------------------


def restarted(*kept: Kept) -> tuple[Supervision, list[RecordedEvent]]:
    core = Supervision(actuation_model(), SupervisionSettings(), seconds(100))
    restored = Restored(boot=2, next_event=50, next_change=9, kept=kept)
    return core, list(core.handle(restored, seconds(100)).events)


def there(node: PartName, mode: ModeName) -> NodeReport:
    """Return a complete report of a node in a mode."""
    parameters = actuation_model().nodes[node].modes[mode]
    return NodeReport(node, state=LifecycleState.ACTIVE, parameters=parameters, reachable=True)


def test_a_failed_change_survives_a_restart(robot: Robot) -> None:
    robot.fault(BASE, Fault.REFUSE)
    robot.ask_transition(BASE, "configure")
    outputs = [robot.onboard.handle(message, robot.now) for message in robot.robot.advance(10**12)]
    (kept,) = (
        item.value
        for output in outputs
        for item in output.kept
        if isinstance(item.value, KeptFailedChange)
    )
    core, events = restarted(kept)
    error = core.error(ErrorKey(BASE, "CHANGE_FAILED"))
    assert (error.state, error.since, error.message) == (S.ACTIVE, kept.since, kept.message)
    assert [e.data["part"] for e in events if e.kind == "error.raised"] == [BASE]


def test_a_change_that_the_restart_interrupted_has_failed() -> None:
    running = KeptChange(
        id="c3",  # type: ignore[arg-type]
        part=ARM,
        started_at=seconds(99),
        cause=40,
        transition=Transition.CONFIGURE,
    )
    core, _ = restarted(running)
    error = core.error(ErrorKey(ARM, "CHANGE_FAILED"))
    assert (error.state, error.message) == (S.ACTIVE, "change c3 failed: restart")


def test_a_failed_change_of_a_part_that_is_no_more_is_left_out_and_told() -> None:
    gone = KeptFailedChange(PartName("gripper"), "c1", "change c1 failed", "failed", 3)  # type: ignore[arg-type]
    core, events = restarted(gone)
    told = [e.event.words for e in events if e.kind == "service.not_restored"]
    assert told == [
        "the failed change of gripper is not restored: there is no part gripper any more"
    ]
    assert "gripper.CHANGE_FAILED" not in core.open_errors()


def test_after_the_next_success_nothing_is_kept(robot: Robot) -> None:
    robot.fault(BASE, Fault.REFUSE)
    robot.ask_transition(BASE, "configure")
    robot.advance(1)
    robot.fault(BASE, None)
    robot.ask_transition(BASE, "configure")
    forgotten: list[Keeping] = []
    for message in robot.robot.advance(robot.now + seconds(5)):
        forgotten += robot.onboard.handle(message, robot.now + seconds(5)).kept
    assert [(k.name, k.value) for k in forgotten if k.kind is KeptFailedChange] == [(BASE, None)]


def heard_late(*reports: tuple[float, NodeReport]) -> tuple[Supervision, list[RecordedEvent]]:
    """Restart a robot in PERFORMANCE, of whose nodes this is reported so long after that."""
    target = KeptTarget(ACTUATION, active(PERFORMANCE), 1)
    core, events = restarted(target)
    for after_s, report in reports:
        events += core.handle(report, seconds(100 + after_s)).events
    return core, [event for event in events if is_error_of_part(event)]


def is_error_of_part(event: RecordedEvent) -> bool:
    return event.kind.startswith("error.") and event.data["part"] is not None


def open_of_parts(core: Supervision) -> list[str]:
    return [name for name in core.open_errors() if "." in name]


@pytest.mark.parametrize("after_s", [0.9, 1.64, 60])
def test_that_a_node_was_not_heard_yet_is_no_deviation_that_is_told(after_s: float) -> None:
    core, told = heard_late(
        (after_s, there(ARM, STRONG)),
        (after_s, there(BASE, FAST)),
    )
    assert (told, open_of_parts(core)) == ([], [])


def test_a_part_deviates_because_of_a_node_that_was_not_heard_yet_without_a_word() -> None:
    core, told = heard_late((60, there(ARM, STRONG)))
    assert told == []
    for part in (BASE, ACTUATION):
        error = core.error(ErrorKey(part, "DEVIATES"))
        assert (error.state, error.roots) == (S.ACTIVE, (ErrorKey(BASE, "UNREACHABLE"),))


def test_that_a_node_cannot_be_reached_at_the_start_is_not_told_either() -> None:
    core, told = heard_late(
        (0, NodeReport(BASE, reachable=False)),
        (5, there(ARM, STRONG)),
        (8, there(BASE, FAST)),
    )
    assert (told, open_of_parts(core)) == ([], [])


def test_once_a_node_is_heard_it_deviates_as_any_other() -> None:
    core, told = heard_late(
        (5, there(ARM, STRONG)),
        (8, NodeReport(BASE, state=LifecycleState.INACTIVE, reachable=True)),
    )
    pending = core.error(ErrorKey(BASE, "DEVIATES"))
    assert (told, pending.state, pending.since) == ([], S.PENDING, seconds(108))
    events = core.handle(TimePassed(), seconds(109)).events
    raised = [e.data["part"] for e in events if e.kind == "error.raised"]
    assert sorted(map(str, raised)) == [ACTUATION, BASE]
    assert core.error(ErrorKey(ACTUATION, "DEVIATES")).roots == (ErrorKey(BASE, "DEVIATES"),)


# --- the robot as a whole ------------------------------------------------------------------------


def test_no_built_in_error_puts_the_robot_into_error(robot: Robot) -> None:
    robot.read(**GOOD)
    robot.fault(BASE, Fault.DIE)
    robot.fault(ARM, Fault.REFUSE)
    robot.ask_mode(ARM, "WEAK")
    for _ in range(10):
        robot.read(**GOOD)
        robot.advance(0.5)
    assert robot.on(BASE)
    assert robot.on(ARM)
    state = robot.core.system_state()
    assert (state.state, state.error_code, state.errors) == (SystemState.IDLE, 0, ())


def test_the_errors_of_the_robot_are_in_the_same_list() -> None:
    robot = Robot(actuation_model())
    robot.read(**GOOD)
    robot.read(battery_level=0.2)
    low = robot.core.open_errors()["BATTERY_LOW"]
    assert (low.key.part, low.state, low.severity) == (None, S.ACTIVE, "critical")
    assert (low.value, low.threshold, low.since) == (0.2, 0.5, robot.now)
    names = [view.key.name for view in robot.core.errors()]
    assert names[0] == "BATTERY_LOW"
    assert len(names) == len(set(names))
    assert names[-3:] == [
        "manipulator.DEVIATES",
        "manipulator.CHANGE_FAILED",
        "manipulator.INVARIANT_BROKEN",
    ]


# --- INVARIANT_BROKEN ----------------------------------------------------------------------------


def test_whoever_judges_invariants_raises_and_clears_their_error() -> None:
    outbox, model = Outbox(), actuation_model()
    found = ErrorList(outbox)
    errors = PartErrors(Parts(model, outbox), found, outbox, 0)
    key = ErrorKey(ACTUATION, "INVARIANT_BROKEN")
    broken = Blocker("INVARIANT", "actuation cannot stay FAST: it is too hot", (ACTUATION,))

    assert errors.note_invariant(ACTUATION, broken, 7, seconds(3))
    assert not errors.note_invariant(ACTUATION, broken, 7, seconds(4)), "it is on already"
    view = found.view(key)
    assert (view.state, view.message, view.since) == (S.ACTIVE, broken.message, seconds(3))
    assert view.severity == "warning"
    assert errors.note_invariant(ACTUATION, None, None, seconds(5))
    assert not found.is_on(key)
    assert not errors.note_invariant(ACTUATION, None, None, seconds(6))


# --- large robots --------------------------------------------------------------------------------


class LargeRobot:
    """Two thousand nodes that are all where they were asked to be; reports by hand."""

    def __init__(self, nodes: int = 2_000) -> None:
        self.model: SmhModel = big_model(nodes)
        self.core = Supervision(self.model, SupervisionSettings(), 0)
        self.root = next(iter(self.model.systems))
        for node in self.model.nodes:
            self.core.handle(NodeReport(node, state=LifecycleState.UNCONFIGURED), 0)
        self.events: list[RecordedEvent] = []

    def turns(self, until_s: float) -> list[int]:
        """Let time pass to a moment; return how many errors each turn told."""
        told = []
        end = seconds(until_s)
        while (due := self.core.wake_at()) is not None and due <= end:
            outputs = self.core.handle(TimePassed(), due)
            self.events += outputs.events
            told.append(len(outputs.errors))
        self.core.handle(TimePassed(), end)
        return told

    def count(self, error: str) -> int:
        return self.core.parts_with_errors.get(error, 0)


def test_thousands_that_deviate_at_once_are_told_in_portions_with_the_time_at_which_it_was() -> (
    None
):
    robot = LargeRobot()
    robot.core.handle(ModeRequest(robot.root, "FAST"), 0)
    robot.turns(until_s=60)
    assert robot.core.changes()[0].status == "timed_out"
    deviating = robot.count("DEVIATES")
    assert deviating == len(robot.model.parts)
    raised = [e for e in robot.events if e.kind == "error.raised" and e.data["error"] == "DEVIATES"]
    assert len(raised) == deviating
    views = [view for view in robot.core.errors() if view.key.error == "DEVIATES"]
    assert len({view.since for view in views}) == 1, "however late it was told"


def test_no_turn_tells_more_errors_of_a_large_robot_than_a_portion() -> None:
    robot = LargeRobot()
    robot.core.handle(ModeRequest(robot.root, "FAST"), 0)
    # A portion, and the systems above it, of which these are new causes.
    assert max(robot.turns(until_s=60)) <= 2 * LOOKS_AT_ONCE


def test_who_comes_back_before_its_turn_is_not_told_to_have_deviated() -> None:
    robot = LargeRobot()
    change = robot.core.handle(ModeRequest(robot.root, "FAST"), 0).change
    assert change is not None
    last = list(robot.model.nodes)[-1]
    now = 0
    while not robot.count("DEVIATES"):
        now = robot.core.wake_at() or now
        robot.core.handle(TimePassed(), now)
    robot.core.handle(
        NodeReport(
            last,
            state=LifecycleState.ACTIVE,
            parameters=robot.model.nodes[last].modes[robot.model.modes_of(last)[1]],
        ),
        now,
    )
    robot.turns(until_s=200)
    assert robot.core.error(ErrorKey(last, "DEVIATES")).count == 0


def test_thousands_that_are_heard_late_after_a_restart_leave_nothing() -> None:
    model = big_model(2_000)
    core = Supervision(model, SupervisionSettings(), 0)
    kept = KeptTarget(next(iter(model.systems)), active("FAST"), 1)
    told = list(core.handle(Restored((kept,), boot=2), 0).events)
    now = seconds(3)
    while (due := core.wake_at()) is not None and due <= now:
        told += core.handle(TimePassed(), now).events
    assert core.parts_with_errors["DEVIATES"] == len(model.parts)
    for node in model.nodes:
        parameters = model.nodes[node].modes[FAST]
        report = NodeReport(node, state=LifecycleState.ACTIVE, parameters=parameters)
        told += core.handle(report, now).events
        now += seconds(0.01)
    while (due := core.wake_at()) is not None and due <= now + seconds(5):
        told += core.handle(TimePassed(), max(due, now)).events
    assert [event for event in told if is_error_of_part(event)] == []
    assert open_of_parts(core) == []
