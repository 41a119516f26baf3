"""Changes, told as what an operator asks for and sees."""

from typing import Any

import pytest

from domain.changes.change_log import KEPT_CHANGES
from domain.errors import InvalidValueError, UnknownChangeError
from domain.health.part_errors import DEVIATES_AFTER
from domain.identifiers import ChangeId
from domain.inputs import (
    CancelRequest,
    ModeRequest,
    NodeAnswer,
    NodeReport,
    TimePassed,
    TransitionRequest,
)
from domain.lifecycle import LifecycleState, Transition
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.snapshot import ChangeStatus, StepStatus
from domain.state_and_mode import DEFAULT_MODE, PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    SLOW,
    actuation_model,
    inactive,
    nested_model,
)


@pytest.fixture
def robot() -> CoreRobot:
    robot = CoreRobot(actuation_model())
    robot.read(**GOOD)
    return robot


def test_the_four_steps_of_annex_4(robot: CoreRobot) -> None:
    """D4.8, Annex 4: configure, activate, PERFORMANCE, then both parts by hand."""
    robot.ask_transition("actuation", "configure")
    robot.advance(1)
    assert [robot.actual(p) for p in robot.model.parts] == ["inactive", "inactive", "inactive"]

    robot.ask_transition("actuation", "activate")
    robot.advance(1)
    assert robot.actual("actuation") == "active.__DEFAULT__"
    assert robot.actual("drive_base") == "active.__DEFAULT__"
    assert robot.actual("manipulator") == "inactive"

    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(1)
    assert robot.actual("actuation") == "active.PERFORMANCE"
    assert robot.actual("drive_base") == "active.FAST"
    assert robot.actual("manipulator") == "active.STRONG"

    robot.ask_mode("drive_base", "SLOW")
    robot.ask_mode("manipulator", "WEAK")
    robot.advance(1)
    assert robot.actual("actuation") == "activating.MODERATE"
    target = robot.core.part(robot.model.parts[0]).target
    assert target is not None
    assert target.label == "active.PERFORMANCE"


def test_a_mode_asked_of_unconfigured_nodes_configures_and_activates_them(
    robot: CoreRobot,
) -> None:
    change = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert robot.steps(change) == [
        (node, action, "succeeded")
        for node in ("manipulator", "drive_base")
        for action in ("configure", "set_parameters", "activate")
    ]


def test_a_mode_change_of_active_nodes_sets_parameters_and_nothing_else(
    robot: CoreRobot,
) -> None:
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    change = robot.ask_mode("actuation", "MODERATE")
    robot.advance(1)
    assert {action for _, action, _ in robot.steps(change)} == {"set_parameters"}


def test_a_request_that_is_met_succeeds_at_once_without_a_step(robot: CoreRobot) -> None:
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    change = robot.ask_mode("actuation", "PERFORMANCE")
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert robot.steps(change) == []


def test_parts_go_side_by_side(robot: CoreRobot) -> None:
    change = robot.ask_transition("actuation", "configure")
    robot.advance(0.1)
    assert [status for _, _, status in robot.steps(change)] == ["running", "running"]


def test_a_node_that_refuses_fails_the_change_and_the_other_goes_on() -> None:
    robot = CoreRobot(actuation_model(), nodes={"manipulator": NodeSettings(fault=Fault.REFUSE)})
    robot.read(**GOOD)
    change = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    view = robot.change(change)
    assert view.status is ChangeStatus.FAILED
    assert view.reason is not None
    assert view.reason.startswith("manipulator: configure: rejected")
    assert robot.actual("drive_base") == "active.FAST"


def test_a_node_whose_callback_fails_is_named(robot: CoreRobot) -> None:
    robot.fault("drive_base", Fault.FAIL)
    change = robot.ask_transition("drive_base", "configure")
    robot.advance(1)
    reason = "drive_base: configure: the node went back to unconfigured"
    assert robot.change(change).reason == reason


def test_an_error_in_a_callback_fails_the_change(robot: CoreRobot) -> None:
    robot.fault("drive_base", Fault.ERROR)
    change = robot.ask_transition("drive_base", "configure")
    robot.advance(0.5)
    assert robot.change(change).status is ChangeStatus.FAILED
    assert robot.actual("drive_base") == "errorprocessing"


def test_an_absent_node_refuses_nothing_and_fails_the_change_at_the_deadline() -> None:
    robot = CoreRobot(actuation_model(), nodes={"drive_base": NodeSettings(fault=Fault.DIE)})
    robot.read(**GOOD)
    change = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(9.9)
    assert robot.change(change).status is ChangeStatus.RUNNING
    assert robot.actual("manipulator") == "active.STRONG"
    robot.advance(0.2)
    assert robot.change(change).status is ChangeStatus.FAILED
    assert robot.change(change).reason == "drive_base is unreachable"


def test_a_node_that_dies_during_a_step_times_the_change_out_and_the_system_says_why(
    robot: CoreRobot,
) -> None:
    change = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.1)
    robot.fault("drive_base", Fault.DIE)
    robot.advance(12)
    view = robot.change(change)
    assert view.status is ChangeStatus.TIMED_OUT
    assert view.reason == "drive_base: configure: the node is unreachable"
    part = robot.core.part(robot.model.parts[0])
    assert (part.actual.state, part.actual.reason) == ("unknown", "drive_base is unreachable")
    assert not part.converged
    assert not part.reachable


def test_a_newer_request_supersedes_the_older_one_and_waits_for_its_step(
    robot: CoreRobot,
) -> None:
    older = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.1)
    newer = robot.ask_transition("actuation", "cleanup")
    assert robot.change(older).status is ChangeStatus.SUPERSEDED
    assert [s for _, _, s in robot.steps(older)].count("running") == 2
    robot.advance(2)
    assert robot.change(newer).status is ChangeStatus.SUCCEEDED
    assert robot.actual("actuation") == "unconfigured"


def test_a_request_for_a_part_supersedes_its_system_and_the_other_part_arrives(
    robot: CoreRobot,
) -> None:
    older = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.1)
    newer = robot.ask_mode("drive_base", "SLOW")
    assert robot.change(older).status is ChangeStatus.SUPERSEDED
    assert robot.change(older).reason == f"superseded by change {newer} of drive_base"
    robot.advance(2)
    assert robot.change(newer).status is ChangeStatus.SUCCEEDED
    assert robot.actual("drive_base") == "active.SLOW"
    assert robot.actual("manipulator") == "active.STRONG"


def test_a_canceled_change_begins_no_further_step_and_keeps_its_target(
    robot: CoreRobot,
) -> None:
    change = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.1)
    robot.give(CancelRequest(change))
    robot.advance(2)
    view = robot.change(change)
    assert view.status is ChangeStatus.CANCELED
    assert robot.actual("drive_base") == "inactive"
    statuses = [step.status for step in view.steps]
    assert statuses == [StepStatus.SUCCEEDED, StepStatus.CANCELED, StepStatus.CANCELED] * 2
    target = robot.core.part(robot.model.parts[0]).target
    assert target is not None
    assert target.label == "active.PERFORMANCE"


def test_canceling_twice_is_harmless_and_an_unknown_change_is_told(robot: CoreRobot) -> None:
    change = robot.ask_mode("actuation", "PERFORMANCE")
    robot.give(CancelRequest(change))
    robot.give(CancelRequest(change))
    with pytest.raises(UnknownChangeError) as unknown:
        robot.give(CancelRequest(ChangeId("c99")))
    assert unknown.value.message == "there is no change 'c99'"
    assert unknown.value.hint == "the last 1000 changes are kept; see GET /changes"


def test_under_an_emergency_stop_a_running_change_activates_nothing_and_fails(
    robot: CoreRobot,
) -> None:
    change = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.1)
    robot.stop()
    robot.advance(2)
    view = robot.change(change)
    assert view.status is ChangeStatus.FAILED
    assert view.reason is not None
    assert "drive_base is not activated while ESTOP is active" in view.reason
    failed = [(node, action) for node, action, status in robot.steps(change) if status == "failed"]
    assert failed == [("manipulator", "activate"), ("drive_base", "activate")]
    assert robot.actual("drive_base") == "inactive"
    assert robot.actual("manipulator") == "inactive"


def test_deactivating_a_system_leaves_its_unconfigured_parts_alone(robot: CoreRobot) -> None:
    robot.ask_mode("drive_base", "FAST")
    robot.advance(2)
    change = robot.ask_transition("actuation", "deactivate")
    robot.advance(2)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert robot.actual("actuation") == "inactive"
    assert robot.actual("manipulator") == "unconfigured"
    assert all(view.converged for view in robot.core.parts().values())


def test_an_absent_node_that_turns_out_to_be_unconfigured_is_left_alone_too(
    robot: CoreRobot,
) -> None:
    robot.ask_mode("drive_base", "FAST")
    robot.advance(2)
    robot.fault("manipulator", Fault.DIE)
    robot.advance(1)
    change = robot.ask_transition("actuation", "deactivate")
    robot.advance(2)
    robot.fault("manipulator", None)
    robot.advance(2)
    assert robot.actual("manipulator") == "unconfigured"
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert all(view.converged for view in robot.core.parts().values())


def test_a_system_whose_nodes_refuse_has_not_converged_though_it_is_called_inactive() -> None:
    refuses = NodeSettings(fault=Fault.REFUSE)
    robot = CoreRobot(actuation_model(), nodes={"drive_base": refuses, "manipulator": refuses})
    robot.read(**GOOD)
    change = robot.ask_transition("actuation", "configure")
    robot.advance(2)
    assert robot.change(change).status is ChangeStatus.FAILED
    view = robot.core.part(ACTUATION)
    assert (view.actual.state, view.converged) == (LifecycleState.INACTIVE, False)
    assert view.deviation_reason == "drive_base is unconfigured, target inactive"
    assert view.deviation_since is not None


def test_a_node_that_falls_back_before_the_last_one_arrives_fails_the_change() -> None:
    robot = CoreRobot(actuation_model(), nodes={"manipulator": NodeSettings(configure=seconds(2))})
    robot.read(**GOOD)
    change = robot.ask_transition("actuation", "configure")
    robot.advance(1)
    robot.give(NodeReport(BASE, state=LifecycleState.UNCONFIGURED))
    robot.advance(2)
    assert {status for _, _, status in robot.steps(change)} == {"succeeded"}
    assert robot.actual("actuation") == "inactive"
    view = robot.change(change)
    assert view.status is ChangeStatus.FAILED
    assert view.reason == "drive_base is unconfigured, target inactive"


def test_a_finalized_part_does_not_keep_the_rest_from_being_deactivated(
    robot: CoreRobot,
) -> None:
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    robot.ask_transition("manipulator", "shutdown")
    robot.advance(2)
    change = robot.ask_transition("actuation", "deactivate")
    robot.advance(2)
    assert robot.actual("drive_base") == "inactive"
    view = robot.change(change)
    assert view.status is ChangeStatus.FAILED
    assert view.reason == "actuation is deactivating, not inactive; manipulator is finalized"


def test_an_active_node_whose_parameters_match_no_mode_deviates_from_the_default(
    robot: CoreRobot,
) -> None:
    robot.ask_transition("drive_base", "activate")
    robot.advance(1)
    robot.nodes.set_parameters(BASE, {"max_speed": 7.7}, robot.now)
    robot.advance(0)
    view = robot.core.part(BASE)
    assert (view.actual.mode, view.converged) == (None, False)


def test_canceling_a_superseded_change_stops_the_nodes_that_it_still_drives(
    robot: CoreRobot,
) -> None:
    older = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.1)
    robot.ask_mode("drive_base", "SLOW")
    robot.give(CancelRequest(older))
    robot.advance(2)
    assert robot.actual("manipulator") == "inactive"
    assert robot.happened("change.cancel_requested") == [{"change": older}]


def test_a_mode_of_a_nested_system_reaches_all_nodes() -> None:
    robot = CoreRobot(nested_model())
    robot.read(**GOOD)
    change = robot.ask_mode("robot", "RACE")
    robot.advance(2)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert robot.actual("robot") == "active.RACE"
    assert robot.actual("actuation") == "active.PERFORMANCE"


def test_every_event_of_a_change_points_at_what_caused_it(robot: CoreRobot) -> None:
    change = robot.ask_transition("drive_base", "configure")
    robot.advance(1)
    by_id = {event.id: event for event in robot.events}
    last = next(e for e in robot.events if e.kind == "change.succeeded")
    kinds = []
    event = last
    while True:
        kinds.append(event.kind)
        if event.cause is None:
            break
        event = by_id[event.cause]
    assert kinds == ["change.succeeded", "node.reported", "change.step_started", "change.requested"]
    assert robot.change(change).cause == event.id


def test_a_report_with_a_value_that_is_none_of_a_parameter_is_refused_whole(
    robot: CoreRobot,
) -> None:
    before = robot.core.part(BASE)
    bad: dict[str, Any] = {"max_speed": 0.9, "controller": None}
    with pytest.raises(InvalidValueError):
        robot.give(NodeReport(BASE, state=LifecycleState.ACTIVE, parameters=bad))
    assert robot.core.part(BASE) is before


def test_changes_are_kept_up_to_a_number_and_the_oldest_are_forgotten(
    robot: CoreRobot,
) -> None:
    first = robot.ask_transition("drive_base", "configure")
    robot.advance(1)
    for _ in range(KEPT_CHANGES):
        newest = robot.ask_transition("drive_base", "configure")
    with pytest.raises(UnknownChangeError):
        robot.change(first)
    assert len(robot.core.changes()) == KEPT_CHANGES
    assert [change.id for change in robot.core.changes(limit=1)] == [newest]
    assert robot.core.changes(part=ACTUATION) == ()


def test_a_node_that_a_superseded_change_still_drives_says_so_until_it_is_there(
    robot: CoreRobot,
) -> None:
    older = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.1)
    robot.ask_mode("drive_base", "SLOW")
    assert robot.core.part(ARM).change == older
    assert robot.core.part(ACTUATION).change is None
    robot.advance(2)
    assert robot.core.part(ARM).change is None


def test_a_blocker_says_since_when(robot: CoreRobot) -> None:
    robot.advance(3)
    robot.ask_transition("drive_base", "shutdown")
    robot.advance(5)
    (blocker,) = robot.core.modes(BASE)[0].blockers
    assert (blocker.code, blocker.since) == ("FINALIZED", seconds(3.2))


# --- a node for which the test speaks ------------------------------------------------------------


def _core() -> Supervision:
    core = Supervision(actuation_model(), SupervisionSettings(), 0)
    core.handle(NodeReport(BASE, state=LifecycleState.UNCONFIGURED), 0)
    return core


def _configure(core: Supervision) -> None:
    core.handle(TransitionRequest(BASE, Transition.CONFIGURE), 0)


@pytest.mark.parametrize(
    ("transition", "state"),
    [(Transition.CONFIGURE, "inactive"), (Transition.SHUTDOWN, "finalized")],
)
def test_a_plain_node_does_not_keep_its_system_from_going(
    transition: Transition, state: str
) -> None:
    robot = CoreRobot(actuation_model(), nodes={BASE: NodeSettings(plain=True)})
    robot.advance(0.1)
    change = robot.give(TransitionRequest(ACTUATION, transition)).change
    robot.advance(5)

    assert change is not None
    assert robot.core.change(change).status is ChangeStatus.SUCCEEDED
    assert {step.node for step in robot.core.change(change).steps} == {ARM}
    assert (robot.actual("actuation"), robot.actual("drive_base")) == (state, "active")


# --- when, and in which words --------------------------------------------------------------------


def test_a_canceled_change_ends_now_and_says_why() -> None:
    core = _core()
    core.handle(ModeRequest(BASE, SLOW), 0)
    core.handle(CancelRequest(ChangeId("c1")), seconds(1))
    change = core.change("c1")
    assert (change.reason, change.ended_at) == ("canceled on request", seconds(1))
    assert [step.ended_at for step in change.steps] == [None, seconds(1), seconds(1)]


def test_what_a_newer_change_takes_over_is_superseded_and_has_no_deadline_left() -> None:
    """Once that is canceled, too, nothing is due but that its parts deviate for too long."""
    core = Supervision(actuation_model(), SupervisionSettings(), 0)
    core.handle(TransitionRequest(BASE, Transition.CONFIGURE), 0)
    core.handle(TransitionRequest(ACTUATION, Transition.CONFIGURE), seconds(4))
    older = core.change("c1")
    assert older.status is ChangeStatus.SUPERSEDED
    assert [(step.status, step.ended_at) for step in older.steps] == [
        (StepStatus.SUPERSEDED, seconds(4))
    ]
    core.handle(CancelRequest(ChangeId("c2")), seconds(5))
    assert core.wake_at() == seconds(5) + DEVIATES_AFTER
    core.handle(TimePassed(), seconds(7))
    assert core.wake_at() is None


@pytest.mark.parametrize(
    ("nodes", "end"), [(20, "n19: configure: rejected"), (21, "; and 1 more"), (22, "; and 2 more")]
)
def test_of_many_errors_twenty_are_told(nodes: int, end: str) -> None:
    names = [PartName(f"n{number}") for number in range(nodes)]
    wanted = {name: inactive() for name in names}
    all_of_them = SystemModel(PartName("all"), {DEFAULT_MODE: wanted})
    core = Supervision(
        SmhModel({name: NodeModel(name) for name in names}, {all_of_them.name: all_of_them}),
        SupervisionSettings(),
        0,
    )
    for name in names:
        core.handle(NodeReport(name, state=LifecycleState.UNCONFIGURED), 0)
    core.handle(TransitionRequest(all_of_them.name, Transition.CONFIGURE), 0)
    for number, name in enumerate(names):
        core.handle(NodeAnswer(number + 1, name, False), 0)
    reason = core.change("c1").reason
    assert reason is not None
    assert reason.count("rejected") == 20
    assert reason.endswith(end)


def test_the_life_of_a_change_is_told_step_by_step() -> None:
    robot = CoreRobot(actuation_model())
    robot.read(**GOOD)
    robot.advance(1)
    change = robot.ask_mode("drive_base", "SLOW")
    robot.advance(2)
    told = [
        (event.at - seconds(1), event.kind, dict(event.data))
        for event in robot.events
        if event.kind.startswith("change.")
    ]

    def step(action: str) -> dict[str, object]:
        return {"change": change, "node": "drive_base", "action": action}

    def ended(action: str) -> dict[str, object]:
        return {**step(action), "status": "succeeded", "error": None}

    assert told == [
        (0, "change.requested", {"part": "drive_base", "mode": "SLOW"}),
        (0, "change.step_started", step("configure")),
        (seconds(0.3), "change.step_ended", ended("configure")),
        (seconds(0.3), "change.step_started", step("set_parameters")),
        (seconds(0.32), "change.step_ended", ended("set_parameters")),
        (seconds(0.32), "change.step_started", step("activate")),
        (seconds(0.52), "change.step_ended", ended("activate")),
        (
            seconds(0.52),
            "change.succeeded",
            {"change": change, "part": "drive_base", "reason": None},
        ),
    ]
    view = robot.change(change)
    assert (view.started_at, view.ended_at) == (seconds(1), seconds(1.52))
    assert [step.ended_at for step in view.steps] == [
        seconds(1.3),
        seconds(1.32),
        seconds(1.52),
    ]


def test_a_change_that_is_met_begins_and_ends_at_once() -> None:
    core = _core()
    core.handle(NodeReport(BASE, state=LifecycleState.INACTIVE), 0)
    core.handle(TransitionRequest(BASE, Transition.CONFIGURE), seconds(3))
    change = core.change("c1")
    assert change.status is ChangeStatus.SUCCEEDED
    assert (change.started_at, change.ended_at) == (seconds(3), seconds(3))


def test_a_superseded_change_ends_when_the_newer_one_begins() -> None:
    core = _core()
    _configure(core)
    core.handle(ModeRequest(BASE, SLOW), seconds(4))
    assert core.change("c1").ended_at == seconds(4)


def test_only_a_change_that_loses_a_node_is_superseded(robot: CoreRobot) -> None:
    base, arm = robot.ask_mode("drive_base", "SLOW"), robot.ask_mode("manipulator", "WEAK")
    robot.advance(2)
    assert robot.change(base).status is ChangeStatus.SUCCEEDED
    assert robot.change(arm).status is ChangeStatus.SUCCEEDED


def test_large_changes_are_forgotten_earlier_and_running_ones_never(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("domain.changes.change_log.KEPT_PURSUITS", 3)
    core = _core()
    core.handle(NodeReport(ARM, state=LifecycleState.UNCONFIGURED), 0)
    core.handle(TransitionRequest(ARM, Transition.CONFIGURE), 0)
    core.handle(NodeReport(BASE, state=LifecycleState.INACTIVE), 0)
    for _ in range(2):
        core.handle(TransitionRequest(BASE, Transition.CONFIGURE), 0)
    assert [change.id for change in core.changes()] == ["c3", "c2", "c1"]
    core.handle(TransitionRequest(BASE, Transition.CONFIGURE), 0)
    assert [change.id for change in core.changes()] == ["c4", "c3", "c1"]
    core.handle(TransitionRequest(BASE, Transition.CONFIGURE), 0)
    assert [change.id for change in core.changes()] == ["c5", "c4", "c1"]


def test_the_newest_change_is_kept_however_large_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("domain.changes.change_log.KEPT_PURSUITS", 0)
    core = _core()
    core.handle(NodeReport(BASE, state=LifecycleState.INACTIVE), 0)
    for _ in range(3):
        core.handle(TransitionRequest(BASE, Transition.CONFIGURE), 0)
    assert [change.id for change in core.changes()] == ["c3"]
