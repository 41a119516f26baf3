"""Nodes that return, told as what an operator sees who declared `on_return: restore`."""

from collections.abc import Iterable, Mapping

import pytest

from domain.actor import NOBODY, Actor
from domain.changes.settings import ChangeSettings
from domain.errors import IllegalTransitionError
from domain.inputs import (
    BackendStatus,
    CancelRequest,
    ChangeRequest,
    EmergencyStopRequest,
    Input,
    ModeRequest,
    NodeAnswer,
    NodeReport,
    ParametersRequest,
    Reading,
    Readings,
    Restored,
    TimePassed,
    TransitionRequest,
)
from domain.kept import KeptTarget
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outputs
from domain.parameters import Parameters
from domain.parts.system_model import NodeModel, SmhModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.snapshot import ChangeStatus
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    FAST,
    PERFORMANCE,
    SLOW,
    active,
    actuation_model,
)

S = LifecycleState
BOTH = frozenset({BASE, ARM})
FIRST_RUN = Restored()
STARTED: Mapping[PartName, Parameters] = {
    BASE: {"max_speed": 0.0, "controller": "none"},
    ARM: {"max_torque": 0.0},
}
"""What the nodes have set when they start."""


def virtual(
    restored: Iterable[PartName] = BOTH, nodes: dict[str, NodeSettings] | None = None
) -> CoreRobot:
    changes = ChangeSettings(restored_nodes=frozenset(restored))
    robot = CoreRobot(actuation_model(), SupervisionSettings(changes=changes), nodes)
    robot.read(**GOOD)
    return robot


def bare(first: Input = FIRST_RUN) -> Supervision:
    """Return a core whose nodes do nothing but what the test reports."""
    settings = SupervisionSettings(changes=ChangeSettings(restored_nodes=BOTH))
    core = Supervision(actuation_model(), settings, 0)
    core.handle(first, 0)
    core.handle(Readings(tuple(Reading(n, v) for n, v in GOOD.items()), "test"), 0)
    return core


def starts(core: Supervision, at_s: float, node: PartName = BASE) -> Outputs:
    """Let the backend tell of a process that was just started."""
    report = NodeReport(node, state=S.UNCONFIGURED, parameters=STARTED[node], reachable=True)
    return core.handle(report, seconds(at_s))


def falls(core: Supervision, at_s: float) -> None:
    core.handle(NodeReport(BASE, reachable=False), seconds(at_s))


def kinds(outputs: Outputs, of: str = "node.") -> list[str]:
    return [event.kind for event in outputs.events if event.kind.startswith(of)]


# --- it returns ----------------------------------------------------------------------------------


def test_a_node_that_is_killed_and_comes_back_is_brought_to_its_target() -> None:
    robot = virtual()
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    robot.fault("drive_base", Fault.DIE)
    robot.advance(2)
    assert robot.actual("actuation") == "unknown"

    robot.fault("drive_base", None)
    robot.advance(1)

    assert robot.actual("actuation") == "active.PERFORMANCE"
    assert robot.happened("node.restoring") == [{"node": BASE, "target": "active.FAST"}]
    change = robot.core.changes()[0]
    assert (change.request, change.status) == (ModeRequest(BASE, FAST), ChangeStatus.SUCCEEDED)


def test_without_that_setting_a_node_that_comes_back_is_left_as_it_is() -> None:
    robot = virtual(restored=())
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    robot.fault("drive_base", Fault.DIE)
    robot.advance(2)
    robot.fault("drive_base", None)
    robot.advance(20)

    assert (robot.actual("drive_base"), robot.actual("actuation")) == ("unconfigured", "activating")
    assert len(robot.core.changes()) == 1


def test_the_change_is_caused_by_the_report_that_the_node_is_back() -> None:
    core = bare()
    core.handle(ModeRequest(BASE, FAST, Actor("operator")), 0)
    core.handle(TimePassed(), seconds(11))
    events = {event.id: event for event in starts(core, 12).events}

    change = core.changes()[0]
    restoring = events[change.cause]
    assert restoring.kind == "node.restoring"
    assert (restoring.actor, change.request.actor) == (NOBODY, NOBODY)
    assert restoring.cause is not None
    assert events[restoring.cause].kind == "node.reported"
    (started,) = (event for event in events.values() if event.kind == "change.step_started")
    assert started.cause == restoring.id


def test_a_node_that_appears_for_the_first_time_after_it_was_asked_for_is_restored() -> None:
    robot = virtual(nodes={"drive_base": NodeSettings(fault=Fault.DIE)})
    asked = robot.ask_mode("drive_base", "SLOW")
    robot.advance(12)
    assert robot.change(asked).status is ChangeStatus.FAILED

    robot.fault("drive_base", None)
    robot.advance(1)

    assert robot.actual("drive_base") == "active.SLOW"


def test_a_node_of_which_nothing_was_asked_is_left_alone() -> None:
    robot = virtual()
    robot.fault("drive_base", Fault.DIE)
    robot.advance(2)
    robot.fault("drive_base", None)
    robot.advance(2)

    assert (robot.actual("drive_base"), robot.core.changes()) == ("unconfigured", ())


def test_a_node_that_was_only_silent_and_is_where_it_should_be_is_left_alone() -> None:
    robot = virtual()
    robot.ask_mode("drive_base", "SLOW")
    robot.advance(2)
    robot.fault("drive_base", Fault.SILENT)
    robot.advance(5)
    robot.fault("drive_base", None)
    robot.advance(1)

    assert robot.actual("drive_base") == "active.SLOW"
    assert robot.happened("node.restoring") == []


def test_a_process_that_was_started_anew_before_it_was_missed_is_restored() -> None:
    robot = virtual()
    robot.ask_mode("drive_base", "SLOW")
    robot.advance(2)
    robot.fault("drive_base", Fault.DIE)
    robot.advance(0.5)
    robot.fault("drive_base", None)
    robot.advance(1)

    assert robot.happened("node.unreachable") == []
    assert robot.actual("drive_base") == "active.SLOW"


@pytest.mark.parametrize("way", [S.CLEANING_UP, S.ERROR_PROCESSING])
def test_a_node_that_somebody_else_took_there_is_left_there(way: LifecycleState) -> None:
    core = bare()
    starts(core, 0)
    core.handle(NodeReport(BASE, state=S.INACTIVE), 0)
    core.handle(TransitionRequest(BASE, Transition.CONFIGURE), 0)
    core.handle(NodeReport(BASE, state=way), seconds(1))

    assert "node.restoring" not in kinds(starts(core, 2))


@pytest.mark.parametrize(
    ("asked", "found", "step"),
    [
        (Transition.ACTIVATE, S.UNCONFIGURED, Transition.CONFIGURE),
        (Transition.CONFIGURE, S.UNCONFIGURED, Transition.CONFIGURE),
        (Transition.CONFIGURE, S.ACTIVE, Transition.DEACTIVATE),
        (Transition.CLEANUP, S.INACTIVE, Transition.CLEANUP),
    ],
)
def test_it_is_brought_to_whatever_was_asked_from_wherever_it_is(
    asked: Transition, found: LifecycleState, step: Transition
) -> None:
    core = bare()
    core.handle(TransitionRequest(ARM, asked), 0)
    core.handle(TimePassed(), seconds(11))
    back = core.handle(NodeReport(ARM, state=found, reachable=True), seconds(12))

    started = [e.data["action"] for e in back.events if e.kind == "change.step_started"]
    assert started == [step]


def test_a_node_without_modes_is_activated() -> None:
    lidar = PartName("lidar")
    settings = SupervisionSettings(changes=ChangeSettings(restored_nodes=frozenset({lidar})))
    robot = CoreRobot(SmhModel({lidar: NodeModel(lidar)}, {}), settings)
    robot.read(**GOOD)
    robot.ask_transition("lidar", "activate")
    robot.advance(1)
    robot.fault("lidar", Fault.DIE)
    robot.advance(2)
    robot.fault("lidar", None)
    robot.advance(1)

    assert robot.actual("lidar") == "active"


def test_a_node_that_does_not_say_yet_what_it_is_in_is_waited_for() -> None:
    core = bare()
    core.handle(ModeRequest(BASE, FAST), 0)
    core.handle(TimePassed(), seconds(11))

    heard = core.handle(NodeReport(BASE, reachable=True), seconds(12))
    assert kinds(heard) == ["node.reported", "node.reachable"]
    assert kinds(starts(core, 13))[-1] == "node.restoring"


def test_a_node_that_was_shut_down_and_is_started_by_hand_is_not_shut_down_again() -> None:
    robot = virtual()
    robot.ask_transition("drive_base", "shutdown")
    robot.advance(1)
    robot.fault("drive_base", Fault.DIE)
    robot.advance(2)
    robot.fault("drive_base", None)
    robot.advance(1)

    assert robot.actual("drive_base") == "unconfigured"
    assert robot.happened("node.restoring") == []


# --- a change holds it ---------------------------------------------------------------------------


def test_killed_in_a_mode_change_it_fails_the_change_and_is_restored_after_that() -> None:
    robot = virtual(nodes={"manipulator": NodeSettings(activate=seconds(6))})
    asked = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.4)
    robot.fault("drive_base", Fault.DIE)
    robot.advance(2)
    robot.fault("drive_base", None)
    robot.advance(3)

    # The arm is still on its way, and the change of the system goes on for its sake.
    assert robot.change(asked).status is ChangeStatus.RUNNING
    assert robot.actual("drive_base") == "unconfigured"

    robot.advance(2)

    failed = robot.change(asked)
    assert failed.status is ChangeStatus.FAILED
    assert failed.reason == "drive_base: activate: the node is unconfigured instead of active"
    assert robot.actual("actuation") == "active.PERFORMANCE"
    assert robot.core.changes()[0].started_at == failed.ended_at


def test_a_change_that_waits_for_a_node_brings_it_there_by_itself() -> None:
    robot = virtual(nodes={"drive_base": NodeSettings(fault=Fault.DIE)})
    asked = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(5)
    robot.fault("drive_base", None)
    robot.advance(2)

    assert robot.change(asked).status is ChangeStatus.SUCCEEDED
    assert len(robot.core.changes()) == 1


def test_what_such_a_change_fails_at_is_not_tried_again() -> None:
    robot = virtual(nodes={"drive_base": NodeSettings(fault=Fault.DIE)})
    asked = robot.ask_mode("drive_base", "SLOW")
    robot.advance(5)
    robot.fault("drive_base", Fault.REFUSE)
    robot.advance(2)

    assert robot.change(asked).status is ChangeStatus.FAILED
    assert len(robot.core.changes()) == 1


def test_a_node_whose_change_somebody_cancels_is_left_alone() -> None:
    robot = virtual(nodes={"manipulator": NodeSettings(activate=seconds(6))})
    asked = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.4)
    robot.fault("drive_base", Fault.DIE)
    robot.advance(2)
    robot.fault("drive_base", None)
    robot.give(CancelRequest(asked))
    robot.advance(10)

    assert robot.actual("drive_base") == "unconfigured"
    assert len(robot.core.changes()) == 1


def test_a_change_that_is_canceled_elsewhere_keeps_no_node_from_being_restored() -> None:
    core = bare()
    core.handle(ModeRequest(ACTUATION, "PERFORMANCE"), 0)
    other = core.handle(ModeRequest(ARM, "WEAK"), seconds(1)).change
    assert other is not None
    core.handle(ParametersRequest(BASE, {"max_speed": 0.5}), seconds(1))
    starts(core, 2)
    assert core.part(BASE).change is not None
    core.handle(CancelRequest(other), seconds(3))
    core.handle(NodeReport(BASE, parameters={"max_speed": 0.5}), seconds(4))

    assert core.changes()[0].request == ModeRequest(BASE, FAST)


def test_a_node_that_is_gone_again_waits_for_its_next_return() -> None:
    robot = virtual(nodes={"manipulator": NodeSettings(activate=seconds(6))})
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.4)
    robot.fault("drive_base", Fault.DIE)
    robot.advance(2)
    robot.fault("drive_base", None)
    robot.fault("drive_base", Fault.DIE)
    robot.advance(18)
    assert robot.happened("node.restoring") == []

    robot.fault("drive_base", None)
    robot.advance(1)

    assert robot.actual("drive_base") == "active.FAST"


def test_who_asks_for_something_else_meanwhile_gets_that() -> None:
    robot = virtual(nodes={"manipulator": NodeSettings(activate=seconds(6))})
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.4)
    robot.fault("drive_base", Fault.DIE)
    robot.advance(2)
    robot.fault("drive_base", None)
    robot.ask_transition("drive_base", "cleanup")
    robot.advance(10)

    assert robot.actual("drive_base") == "unconfigured"
    assert robot.happened("node.restoring") == []


# --- it is not restored --------------------------------------------------------------------------


def test_under_estop_a_node_is_not_activated_and_that_is_said_once() -> None:
    robot = virtual()
    robot.ask_mode("drive_base", "SLOW")
    robot.advance(1)
    robot.stop()
    robot.fault("drive_base", Fault.DIE)
    robot.advance(2)
    robot.fault("drive_base", None)
    robot.advance(2)
    robot.release_stop()
    robot.advance(20)

    (told,) = robot.happened("node.not_restored")
    assert (told["node"], told["target"]) == (BASE, "active.SLOW")
    assert told["reason"].startswith("drive_base cannot be changed: emergency stop is engaged")
    assert robot.actual("drive_base") == "unconfigured"


def test_without_a_backend_that_is_the_reason() -> None:
    core = bare()
    core.handle(ModeRequest(BASE, SLOW), 0)
    core.handle(TimePassed(), seconds(11))
    core.handle(BackendStatus(available=False, reason="no DDS"), seconds(11))
    (told,) = (e for e in starts(core, 12).events if e.kind == "node.not_restored")

    assert told.data["reason"] == "the nodes cannot be reached: no DDS"


def crashes_when_it_is_activated(core: Supervision, at_s: float) -> Outputs:
    """Let a process fall and be started anew; return what follows from its return."""
    falls(core, at_s)
    outputs = starts(core, at_s + 1)
    core.handle(NodeReport(BASE, state=S.CONFIGURING), seconds(at_s + 2))
    return outputs


def test_a_node_that_falls_whenever_it_is_activated_is_given_up_after_three_times() -> None:
    core = bare()
    core.handle(ModeRequest(BASE, SLOW), 0)
    core.handle(TimePassed(), seconds(11))
    told = [crashes_when_it_is_activated(core, 12 + 10 * n) for n in range(6)]

    assert [kinds(outputs)[-1] for outputs in told] == [
        *["node.restoring"] * 3,
        "node.not_restored",
        *["node.reachable"] * 2,
    ]
    last = next(e for e in told[3].events if e.kind == "node.not_restored")
    assert last.data["reason"] == (
        "it was restored 3 times within 60 s; "
        "it is not restored again until a change of it is requested"
    )


def test_it_is_trusted_again_once_somebody_asks_for_it() -> None:
    core = bare()
    core.handle(ModeRequest(BASE, SLOW), 0)
    core.handle(TimePassed(), seconds(11))
    for number in range(4):
        crashes_when_it_is_activated(core, 12 + 5 * number)
    core.handle(ModeRequest(BASE, SLOW, Actor("operator")), seconds(30))
    core.handle(TimePassed(), seconds(42))

    assert kinds(crashes_when_it_is_activated(core, 43))[-1] == "node.restoring"


def test_setting_its_parameters_is_not_asking_for_it() -> None:
    core = bare()
    core.handle(ModeRequest(BASE, SLOW), 0)
    core.handle(TimePassed(), seconds(11))
    for number in range(4):
        crashes_when_it_is_activated(core, 12 + 5 * number)
    core.handle(ParametersRequest(BASE, {"max_speed": 0.5}), seconds(40))
    core.handle(TimePassed(), seconds(50))

    assert "node.restoring" not in kinds(crashes_when_it_is_activated(core, 51))


@pytest.mark.parametrize(
    ("fourth_at_s", "kind"), [(72.9, "node.not_restored"), (73.0, "node.restoring")]
)
def test_only_the_last_minute_counts(fourth_at_s: float, kind: str) -> None:
    core = bare()
    core.handle(ModeRequest(BASE, SLOW), 0)
    core.handle(TimePassed(), seconds(11))
    for at_s in (12.0, 30.0, 50.0):  # Back, and restored, a second later.
        crashes_when_it_is_activated(core, at_s)

    assert kinds(crashes_when_it_is_activated(core, fourth_at_s - 1))[-1] == kind


def test_whoever_frees_a_node_is_not_who_left_it_as_it_is() -> None:
    core = bare()
    # The base refuses and falls, while the arm, which never came, keeps the change running.
    starts(core, 1)
    core.handle(ModeRequest(ACTUATION, PERFORMANCE, Actor("operator")), seconds(2))
    core.handle(NodeAnswer(1, BASE, accepted=False, reason="not today"), seconds(2))
    falls(core, 3)
    starts(core, 4)
    core.handle(EmergencyStopRequest(engaged=True, reason="", actor=Actor("operator")), seconds(5))

    request = TransitionRequest(ARM, Transition.CONFIGURE, Actor("mechanic"))
    outputs = core.handle(request, seconds(6))

    told = [event for event in outputs.events if event.kind == "node.not_restored"]
    assert [(event.actor.label, event.data["node"]) for event in told] == [("", BASE)]


# --- after a restart of the service --------------------------------------------------------------


def restarted() -> Supervision:
    """Return a core that was restarted after the system was asked for `PERFORMANCE`."""
    return bare(Restored((KeptTarget(ACTUATION, active(PERFORMANCE), 1),), boot=2))


def test_after_a_restart_a_node_that_is_off_its_target_is_shown_and_left_as_it_is() -> None:
    core = restarted()
    told = starts(core, 1)

    assert "node.restoring" not in kinds(told)
    assert told.commands == ()
    assert core.part(BASE).deviation_reason == "drive_base is unconfigured, target active.FAST"


def test_after_a_restart_it_is_left_as_it_is_also_when_it_vanishes_and_returns() -> None:
    core = restarted()
    for at_s in range(10, 40, 10):
        starts(core, at_s)
        falls(core, at_s + 5)
        assert core.changes() == ()


@pytest.mark.parametrize(
    "request_",
    [
        TransitionRequest(BASE, Transition.CONFIGURE),
        ParametersRequest(BASE, {"max_speed": 0.5}),
        ModeRequest(ACTUATION, PERFORMANCE),
    ],
    ids=["of the node", "of its parameters", "of its system"],
)
def test_once_something_is_requested_of_it_or_of_its_system_it_is_restored_again(
    request_: ChangeRequest,
) -> None:
    core = restarted()
    starts(core, 1)
    core.handle(request_, seconds(2))
    core.handle(TimePassed(), seconds(20))
    falls(core, 20)

    assert "node.restoring" in kinds(starts(core, 30))


def test_a_request_of_another_part_or_one_that_is_rejected_changes_nothing_about_it() -> None:
    core = restarted()
    starts(core, 1)
    core.handle(TransitionRequest(ARM, Transition.CONFIGURE), seconds(2))
    with pytest.raises(IllegalTransitionError):
        core.handle(TransitionRequest(BASE, Transition.DEACTIVATE), seconds(2))
    falls(core, 20)

    assert "node.restoring" not in kinds(starts(core, 30))


def test_a_request_before_its_first_report_waits_until_the_node_says_what_it_is_in() -> None:
    core = restarted()
    asked = core.handle(ModeRequest(BASE, FAST), seconds(1))
    assert asked.commands == ()

    there: Parameters = {"max_speed": 0.9, "controller": "MPC"}
    report = NodeReport(BASE, state=S.ACTIVE, parameters=there, reachable=True)
    assert core.handle(report, seconds(2)).commands == (), "it runs in that mode already"
    assert core.changes()[0].status is ChangeStatus.SUCCEEDED
