"""Whose word counts at a device, told as its supervisor and the people beside it see it."""

import pytest

from domain.actor import Actor
from domain.commands import ActAlone, AnswerOrder, AskFacts, AskTransition, TellReaction
from domain.computers import DeviceState
from domain.devices.lead import ORDER_WAITS
from domain.devices.lead_view import Word
from domain.devices.settings import OfflineSettings
from domain.errors import OfflineError, OwnedBySupervisorError, PilothouseError
from domain.inputs import (
    CancelRequest,
    ErrorReport,
    ModeRequest,
    NodeAnswer,
    OrderReceived,
    ParametersRequest,
    Restored,
    SupervisorStatus,
    TransitionRequest,
)
from domain.kept import KeptTarget
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import ParameterValue
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault
from domain.snapshot import ChangeStatus, SystemState
from domain.state_and_mode import StateAndMode
from domain.timebase import seconds, to_seconds
from service.checkpoint import checkpoint_of, core_of_checkpoint
from service.files.model_file import read_model
from tests.support.core_robot import CoreRobot
from tests.support.device_robot import SECOND, DeviceRobot, offline
from tests.support.models import BASE, SLOW, actuation_model
from tests.support.paths import straight

AT_REST = offline(drive_base="inactive")


def following(does: OfflineSettings = AT_REST, model: SmhModel | None = None) -> DeviceRobot:
    robot = DeviceRobot(does, model)
    robot.connect()
    return robot


# --- orders --------------------------------------------------------------------------------------


def test_an_order_reaches_its_node_and_the_answer_the_supervisor() -> None:
    robot = following()

    request = robot.order("drive_base", "configure")
    robot.advance(1)

    assert robot.actual("drive_base") == "inactive"
    assert robot.answer_to(request) == AnswerOrder(request, BASE, accepted=True)


def test_the_node_is_asked_with_a_number_of_the_device() -> None:
    robot = following()

    request = robot.order("drive_base", "configure")

    (command,) = robot.commands
    assert isinstance(command, AskTransition)
    assert command.request != request


def test_what_a_node_rejects_is_told_the_supervisor_in_its_words() -> None:
    robot = following()
    robot.fault("drive_base", Fault.REFUSE)

    answer = robot.answer_to(robot.order("drive_base", "configure"))

    assert not answer.accepted
    assert answer.reason


def test_parameters_are_set_on_order() -> None:
    robot = following()

    robot.carry_out("drive_base", "configure", {"max_speed": 0.2, "controller": "PID"}, "activate")

    assert robot.actual("drive_base") == "active.SLOW"


def test_an_order_leaves_no_target_at_the_device() -> None:
    robot = following()

    robot.activate()

    assert robot.core.part(BASE).target is None
    assert robot.core.system_state().state is SystemState.IDLE


def test_an_order_for_a_node_of_another_device_is_refused() -> None:
    robot = following()

    answer = robot.answer_to(robot.order("manipulator", "configure"))

    assert (answer.accepted, answer.reason) == (False, "device base has no node manipulator")


def test_a_device_that_follows_nobody_refuses_orders() -> None:
    robot = DeviceRobot()

    answer = robot.answer_to(robot.order("drive_base", "configure"))

    assert (answer.accepted, answer.reason) == (False, "device base does not follow a supervisor")
    assert robot.commands == []


def test_a_device_that_is_cut_off_refuses_orders() -> None:
    robot = following()
    robot.lose()

    assert not robot.answer_to(robot.order("drive_base", "configure")).accepted


def test_a_device_that_hears_its_supervisor_late_still_follows() -> None:
    robot = following()
    robot.be_late()

    assert robot.answer_to(robot.order("drive_base", "configure")).accepted
    assert robot.lead.word is Word.SUPERVISOR


def test_nothing_is_activated_on_order_while_a_stop_is_engaged_here() -> None:
    robot = following()
    robot.carry_out("drive_base", "configure")
    robot.stop("somebody fell")

    answer = robot.answer_to(robot.order("drive_base", "activate"))
    robot.advance(1)

    assert not answer.accepted
    assert "ESTOP" in answer.reason
    assert robot.actual("drive_base") == "inactive"
    assert [event["reason"] for event in robot.happened("order.refused")] == [answer.reason]


def test_a_node_is_deactivated_on_order_while_a_stop_is_engaged() -> None:
    robot = following()
    robot.activate()
    robot.stop()

    robot.carry_out("drive_base", "deactivate")

    assert robot.actual("drive_base") == "inactive"


def test_an_answer_to_the_supervisor_of_before_is_not_told_the_next_one() -> None:
    robot = following()
    robot.fault("drive_base", Fault.SILENT)
    robot.order("drive_base", "configure")
    (command,) = robot.commands
    robot.lose()
    robot.connect(SECOND)

    robot.give(NodeAnswer(command.request, BASE, accepted=True))  # type: ignore[union-attr]

    assert not [told for told in robot.told if isinstance(told, AnswerOrder)]


def test_a_question_for_facts_leaves_no_trace_in_the_log() -> None:
    robot = following()
    before = len(robot.events)

    robot.give(OrderReceived(AskFacts(7, BASE)))

    assert len(robot.events) == before
    assert [type(command) for command in robot.commands] == [AskFacts]


def test_the_log_says_what_the_supervisor_ordered() -> None:
    robot = following()

    robot.activate()

    assert [event["action"] for event in robot.happened("order.taken")] == [
        "configure",
        "set_parameters",
        "activate",
    ]


# --- requests of people at the device -------------------------------------------------------------

REQUESTS = [
    ModeRequest(BASE, "SLOW"),
    TransitionRequest(BASE, Transition.ACTIVATE),
    TransitionRequest(BASE, Transition.SHUTDOWN),
    ParametersRequest(BASE, {"max_speed": 0.1}),
]


@pytest.mark.parametrize("request_", REQUESTS)
def test_while_connected_the_supervisor_is_to_be_asked(request_: ModeRequest) -> None:
    robot = following()

    with pytest.raises(OwnedBySupervisorError) as caught:
        robot.give(request_)

    assert caught.value.message == "drive_base is commanded by the supervisor, which is connected"
    assert "request it of the supervisor" in str(caught.value.hint)


@pytest.mark.parametrize("request_", REQUESTS)
def test_while_cut_off_nobody_can_be_asked(request_: ModeRequest) -> None:
    robot = following()
    robot.lose()

    with pytest.raises(OfflineError, match="which base cannot hear: not heard"):
        robot.give(request_)


def test_before_it_was_connected_nobody_can_be_asked() -> None:
    with pytest.raises(OfflineError, match="it was never connected since its start"):
        DeviceRobot().ask_mode("drive_base", "SLOW")


def test_what_a_request_would_do_is_refused_alike() -> None:
    with pytest.raises(OwnedBySupervisorError):
        following().core.plan(ModeRequest(BASE, "SLOW"))


def test_at_the_device_no_mode_can_be_entered_and_only_rest_is_offered() -> None:
    robot = following()
    robot.activate()

    view = robot.core.mode(BASE, SLOW)

    assert not view.can_enter
    assert view.blockers[0].code == "OWNED_BY_SUPERVISOR"
    assert robot.core.available_transitions(BASE) == (Transition.DEACTIVATE,)

    robot.lose()
    assert robot.core.mode(BASE, SLOW).blockers[0].code == "OFFLINE"


def test_the_vehicle_is_the_supervisors() -> None:
    with pytest.raises(OwnedBySupervisorError, match="the vehicle is commanded by the supervisor"):
        following().submit_task(straight())


def test_a_request_that_is_refused_changes_nothing() -> None:
    robot = following()
    before = len(robot.events)

    with pytest.raises(PilothouseError):
        robot.ask_mode("drive_base", "SLOW")

    assert len(robot.events) == before
    assert robot.commands == []


@pytest.mark.parametrize("state", ["following", "cut off", "never connected"])
def test_stop_hold_and_deactivate_always_pass(state: str) -> None:
    robot = DeviceRobot()
    if state != "never connected":
        robot.connect()
    if state == "cut off":
        robot.lose()

    robot.stop()
    robot.hold()
    robot.release()
    robot.release_stop()
    with pytest.raises(PilothouseError, match="it cannot deactivate"):
        robot.ask_transition("drive_base", "deactivate")


def test_somebody_at_the_device_brings_it_to_rest() -> None:
    robot = following()
    robot.activate()

    change = robot.ask_transition("drive_base", "deactivate")
    robot.advance(1)

    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert robot.actual("drive_base") == "inactive"


def test_an_order_to_activate_is_refused_while_the_node_does_what_was_requested_here() -> None:
    robot = following()
    robot.activate()
    robot.ask_transition("drive_base", "deactivate")

    answer = robot.answer_to(robot.order("drive_base", "activate"))

    assert (answer.accepted, answer.reason) == (
        False,
        "drive_base is busy on request of the device: deactivate",
    )


def test_an_order_towards_rest_waits_until_what_was_requested_here_is_done() -> None:
    robot = following()
    robot.activate()
    robot.ask_transition("drive_base", "deactivate")

    request = robot.order("drive_base", "cleanup")
    assert robot.answers_to(request) == [], "it waits"
    robot.advance(2)

    assert robot.answer_to(request).accepted
    assert robot.actual("drive_base") == "unconfigured"


def test_an_order_that_is_done_when_its_turn_comes_is_not_given_to_the_node() -> None:
    robot = following()
    robot.activate()
    robot.ask_transition("drive_base", "deactivate")

    request = robot.order("drive_base", "deactivate")
    robot.advance(2)

    assert robot.answer_to(request).accepted
    asked = [each for each in robot.commands if isinstance(each, AskTransition)]
    assert [each.transition for each in asked].count(Transition.DEACTIVATE) == 1


def test_an_order_does_not_wait_for_ever() -> None:
    robot = following()
    robot.activate()
    robot.robot.nodes.set_fault(BASE, Fault.SILENT, robot.now)
    robot.ask_transition("drive_base", "deactivate")

    request = robot.order("drive_base", "deactivate")
    robot.advance(to_seconds(ORDER_WAITS) - 0.1)
    assert robot.answers_to(request) == []
    robot.advance(0.2)

    assert robot.answer_to(request).reason == (
        "drive_base is busy on request of the device: deactivate"
    )


def test_an_order_that_waits_is_void_once_the_supervisor_is_lost() -> None:
    robot = following()
    robot.activate()
    robot.ask_transition("drive_base", "deactivate")
    request = robot.order("drive_base", "cleanup")

    robot.lose()
    robot.advance(2)

    assert robot.answers_to(request) == []
    assert robot.actual("drive_base") == "inactive"


def test_of_two_orders_that_wait_for_a_node_the_later_one_is_carried_out() -> None:
    robot = following()
    robot.activate()
    robot.ask_transition("drive_base", "deactivate")
    first = robot.order("drive_base", "deactivate")

    second = robot.order("drive_base", "cleanup")
    robot.advance(2)

    assert robot.answers_to(first) == []
    assert robot.answer_to(second).accepted


def test_a_later_order_replaces_what_was_requested_at_the_device() -> None:
    robot = following()
    robot.activate()
    robot.ask_transition("drive_base", "deactivate")
    robot.advance(1)

    robot.carry_out("drive_base", "activate")

    assert robot.core.part(BASE).target is None
    assert robot.actual("drive_base") == "active.__DEFAULT__"


def test_a_change_is_canceled_at_the_device() -> None:
    robot = following()
    robot.activate()
    change = robot.ask_transition("drive_base", "deactivate")

    robot.give(CancelRequest(change, Actor("operator")))

    assert robot.change(change).status is ChangeStatus.CANCELED


# --- cut off -------------------------------------------------------------------------------------


def test_a_device_acts_alone_once_it_is_cut_off_for_long_enough() -> None:
    robot = following(offline(after_s=2, drive_base="inactive"))
    robot.activate()
    robot.lose()

    robot.advance(0.49)
    assert (robot.lead.word, robot.actual("drive_base")) == (Word.CUT_OFF, "active.__DEFAULT__")

    robot.advance(0.01)
    assert robot.lead.word is Word.DEVICE
    assert robot.told[-1] == ActAlone(autonomous=True)

    robot.advance(1)
    assert robot.actual("drive_base") == "inactive"


def test_the_log_says_what_a_device_does_alone_and_in_whose_name() -> None:
    robot = following()
    robot.activate()
    robot.lose()
    robot.advance(2)

    (alone,) = robot.happened("device.acts_alone")
    requested = [event for event in robot.events if event.kind == "change.requested"]

    assert alone == {"device": "base", "does": "after 2 s: drive_base to inactive"}
    assert [event.actor.label for event in requested] == ["device base, acting alone"]


def test_a_device_that_was_never_connected_does_nothing_alone() -> None:
    robot = DeviceRobot(AT_REST)
    robot.lose()

    robot.advance(10)

    assert robot.commands == []
    assert robot.lead.word is Word.NOBODY


def test_a_device_that_was_started_anew_does_nothing_until_it_was_connected() -> None:
    robot = DeviceRobot(AT_REST)
    robot.give(Restored((KeptTarget(BASE, StateAndMode(LifecycleState.ACTIVE), 1),), boot=2))
    robot.advance(10)

    assert robot.commands == []


def test_a_device_without_an_offline_block_stays_as_it_is() -> None:
    robot = following(offline())
    robot.activate()
    robot.lose()

    robot.advance(10)

    assert robot.actual("drive_base") == "active.__DEFAULT__"
    assert robot.happened("device.acts_alone") == [
        {"device": "base", "does": "after 2 s: nothing changes"}
    ]


def test_a_cut_that_ends_in_time_has_no_consequence() -> None:
    robot = following()
    robot.activate()
    robot.lose()
    robot.advance(0.4)

    robot.connect()
    robot.advance(10)

    assert robot.actual("drive_base") == "active.__DEFAULT__"
    assert robot.happened("device.acts_alone") == robot.happened("device.follows_again") == []


def test_a_supervisor_that_must_not_be_dealt_with_is_as_good_as_none() -> None:
    robot = following()
    robot.activate()

    robot.give(SupervisorStatus(DeviceState.CONFLICT, "it has another model"))
    robot.advance(1.9)
    assert robot.actual("drive_base") == "active.__DEFAULT__"

    robot.advance(1)
    assert robot.actual("drive_base") == "inactive"


def test_a_loss_that_turns_out_to_be_a_conflict_does_not_begin_anew() -> None:
    robot = following()
    robot.lose()
    robot.advance(0.4)

    robot.give(SupervisorStatus(DeviceState.CONFLICT, "it has another model"))
    robot.advance(0.1)

    assert robot.lead.word is Word.DEVICE


def test_a_device_never_activates_alone_under_a_stop() -> None:
    robot = following(offline(drive_base="active.SLOW"))
    robot.stop()
    robot.lose()

    robot.advance(10)

    (left,) = robot.happened("device.target_left")
    assert left["target"] == "active.SLOW"
    assert "emergency stop is engaged" in left["reason"]
    assert robot.actual("drive_base") == "unconfigured"


def test_what_a_stop_prevented_is_not_made_up_for() -> None:
    robot = following(offline(drive_base="active.SLOW"))
    robot.stop()
    robot.lose()
    robot.advance(10)

    robot.release_stop()
    robot.advance(10)

    assert robot.actual("drive_base") == "unconfigured"


def test_a_device_activates_alone_what_its_file_says() -> None:
    robot = following(offline(drive_base="active.SLOW"))
    robot.lose()

    robot.advance(10)

    assert robot.actual("drive_base") == "active.SLOW"


def test_what_somebody_brought_to_rest_is_not_activated_alone() -> None:
    robot = following(offline(drive_base="active.SLOW"))
    robot.activate()
    robot.ask_transition("drive_base", "deactivate")
    robot.advance(1)
    robot.lose()

    robot.advance(10)

    (left,) = robot.happened("device.target_left")
    assert left["reason"] == "drive_base was brought to rest on request"
    assert robot.actual("drive_base") == "inactive"


# --- and back ------------------------------------------------------------------------------------


def test_what_is_stays_as_it_is_when_the_supervisor_is_back() -> None:
    robot = following()
    robot.activate()
    robot.lose()
    robot.advance(5)
    commands = len(robot.commands)

    robot.connect()
    robot.advance(10)

    assert len(robot.commands) == commands
    assert robot.core.part(BASE).target is None
    assert robot.told[-1] == ActAlone(autonomous=False)
    assert robot.happened("device.follows_again") == [{"device": "base"}]


def test_what_a_device_was_changing_alone_is_canceled() -> None:
    robot = following(offline(drive_base="active.SLOW"))
    robot.lose()
    robot.advance(0.6)

    robot.connect()
    robot.advance(5)

    (change,) = robot.core.changes()
    assert (change.status, change.reason) == (ChangeStatus.CANCELED, "the supervisor is back")
    assert robot.actual("drive_base") == "inactive"


def test_a_step_that_was_canceled_keeps_no_order_waiting() -> None:
    robot = following(offline(drive_base="active.SLOW"))
    robot.lose()
    robot.fault("drive_base", Fault.DIE)
    robot.advance(0.6)
    robot.connect()
    robot.fault("drive_base", None)

    answer = robot.answer_to(robot.order("drive_base", "configure"))

    assert answer.accepted


def test_the_next_cut_counts_anew() -> None:
    robot = following()
    robot.lose()
    robot.advance(5)
    robot.connect()
    robot.carry_out("drive_base", "activate")
    robot.lose()

    robot.advance(0.4)
    assert robot.lead.word is Word.CUT_OFF
    robot.advance(2)

    assert robot.actual("drive_base") == "inactive"


def test_a_target_of_before_a_restart_is_dropped_with_the_first_connection() -> None:
    robot = DeviceRobot()
    robot.give(Restored((KeptTarget(BASE, StateAndMode(LifecycleState.INACTIVE), 1),), boot=2))

    robot.connect()
    outputs = robot.give(SupervisorStatus(DeviceState.LATE, "not heard for 0.5 s"))

    assert robot.core.part(BASE).target is None
    assert outputs.kept == ()


# --- reactions -----------------------------------------------------------------------------------

REACTING = """
drive_base: {ros__parameters: {type: node,
  modes: {__DEFAULT__: {ros__parameters: {max_speed: 0.1}},
          SLOW: {ros__parameters: {max_speed: 0.2}}, FAST: {ros__parameters: {max_speed: 0.9}}},
  errors: {HOT: {}, WARM: {}, BURNT: {}},
  reactions: {COOL: {when: "drive_base.errors.HOT", action: state, target: inactive},
              CALM: {when: "drive_base.errors.WARM", action: mode, target: active.SLOW},
              HALT: {when: "drive_base.errors.BURNT", action: emergency_stop}}}}
manipulator: {ros__parameters: {type: node}}
"""


def reacting(does: OfflineSettings = AT_REST) -> DeviceRobot:
    """Return a device that was ordered to be active and fast."""
    robot = following(does, read_model(REACTING).model)
    robot.carry_out("drive_base", "configure", {"max_speed": 0.9}, "activate")
    return robot


def find(robot: DeviceRobot, error: str, *, active: bool = True) -> None:
    robot.give(ErrorReport(BASE, error, active))
    robot.advance(1)


def told_of(robot: DeviceRobot, reaction: str) -> list[str]:
    return [
        str(told.state)
        for told in robot.told
        if isinstance(told, TellReaction) and told.reaction == reaction
    ]


def test_a_reaction_that_is_all_its_own_acts_at_once_while_connected() -> None:
    robot = reacting()

    find(robot, "HOT")

    assert robot.actual("drive_base") == "inactive"
    assert told_of(robot, "COOL") == ["idle", "acting"]


def test_a_reaction_slows_down_what_the_supervisor_activated() -> None:
    robot = reacting()

    find(robot, "WARM")

    assert robot.actual("drive_base") == "active.SLOW"


def test_a_reaction_does_not_activate_what_the_supervisor_did_not() -> None:
    robot = following(model=read_model(REACTING).model)

    find(robot, "WARM")

    assert robot.actual("drive_base") == "unconfigured"
    assert told_of(robot, "CALM") == ["idle"]


def test_a_reaction_engages_the_stop_of_the_device() -> None:
    robot = reacting()

    find(robot, "BURNT")

    assert robot.core.emergency_stop().engaged


def test_the_end_of_a_reaction_is_told_and_leaves_its_part_as_it_is() -> None:
    robot = reacting()
    find(robot, "WARM")

    find(robot, "WARM", active=False)

    assert told_of(robot, "CALM") == ["idle", "acting", "idle"]
    assert robot.actual("drive_base") == "active.SLOW"


@pytest.mark.parametrize(
    ("error", "order", "kept_in"),
    [
        ("HOT", "activate", "COOL keeps drive_base in inactive"),
        ("WARM", {"max_speed": 0.9}, "CALM keeps drive_base in active.SLOW"),
    ],
)
def test_an_order_against_a_reaction_is_refused(
    error: str, order: str | dict[str, ParameterValue], kept_in: str
) -> None:
    robot = reacting()
    find(robot, error)

    answer = robot.answer_to(robot.order("drive_base", order))

    assert (answer.accepted, answer.reason) == (False, f"reaction {kept_in}")


def test_an_order_that_agrees_with_a_reaction_or_goes_to_rest_passes() -> None:
    robot = reacting()
    find(robot, "WARM")

    robot.carry_out("drive_base", {"max_speed": 0.2}, "deactivate")
    robot.advance(5)

    assert robot.actual("drive_base") == "inactive"


def test_after_a_reaction_the_supervisor_leads_back() -> None:
    robot = reacting()
    find(robot, "WARM")
    find(robot, "WARM", active=False)

    robot.carry_out("drive_base", {"max_speed": 0.9})

    assert robot.actual("drive_base") == "active.FAST"


def test_reactions_act_until_the_device_acts_alone_without_them() -> None:
    robot = reacting(offline())
    robot.lose()
    robot.advance(0.1)
    find(robot, "WARM")
    assert (robot.lead.word, robot.actual("drive_base")) == (Word.DEVICE, "active.SLOW")

    find(robot, "HOT")

    assert robot.actual("drive_base") == "active.SLOW"
    assert "COOL" in [event["reaction"] for event in robot.happened("reaction.would_act")]


def test_reactions_act_while_the_device_acts_alone_if_its_file_says_so() -> None:
    robot = reacting(offline(reactions=True))
    robot.lose()
    robot.advance(2)

    find(robot, "HOT")

    assert robot.actual("drive_base") == "inactive"


def test_a_device_that_was_never_connected_reacts_to_nothing() -> None:
    robot = DeviceRobot(offline(reactions=True), read_model(REACTING).model)

    find(robot, "BURNT")

    assert not robot.core.emergency_stop().engaged


def test_a_reaction_that_began_alone_goes_on_when_the_supervisor_is_back() -> None:
    robot = reacting(offline(reactions=True))
    robot.lose()
    robot.advance(2)
    robot.give(ErrorReport(BASE, "HOT", active=True))

    robot.connect()
    robot.advance(1)

    assert robot.actual("drive_base") == "inactive"
    assert told_of(robot, "COOL")[-1] == "acting"


def test_each_supervisor_is_told_anew_which_reactions_act() -> None:
    robot = reacting()
    find(robot, "HOT")
    robot.lose()
    robot.told.clear()

    robot.connect(SECOND)

    assert (told_of(robot, "COOL"), told_of(robot, "CALM")) == (["acting"], ["idle"])


def test_what_a_reaction_did_alone_stays_when_the_supervisor_is_back() -> None:
    robot = reacting(offline(reactions=True))
    robot.lose()
    find(robot, "HOT")
    robot.advance(5)

    robot.connect()
    find(robot, "HOT", active=False)
    robot.advance(5)

    assert robot.actual("drive_base") == "inactive"
    assert robot.core.part(BASE).target is None


# --- what can be seen ----------------------------------------------------------------------------


def test_what_can_be_seen_says_whose_word_counts() -> None:
    robot = following()
    robot.advance(3)
    robot.lose()

    view = robot.lead

    assert (view.device, view.word, view.supervisor) == ("base", Word.CUT_OFF, DeviceState.LOST)
    assert (view.reason, view.since) == ("not heard for 1.5 s", robot.now)
    assert view.offline == "after 2 s: drive_base to inactive"
    assert robot.lead is view


def test_the_only_computer_of_a_robot_follows_nobody() -> None:
    assert CoreRobot(actuation_model()).core.lead() is None


def test_a_copy_of_a_device_goes_on_as_the_device_does() -> None:
    robot = reacting(offline(drive_base="inactive", reactions=True))
    robot.order("drive_base", {"max_speed": 0.2})
    robot.lose()
    robot.advance(0.2)

    copy = core_of_checkpoint(checkpoint_of(robot.onboard, "1.2"), "1.2")

    for after_s in (0.1, 0.5, 1.0):
        at = robot.now + seconds(after_s)
        given = ErrorReport(BASE, "HOT", active=after_s > 0.5)
        assert copy.handle(given, at) == robot.onboard.handle(given, at)
        assert copy.wake_at() == robot.onboard.wake_at()
    assert copy.core.lead() == robot.core.lead()
