"""A device's end of the link, told as what happens to a robot of two computers."""

from dataclasses import replace

from domain.commands import ActAlone, AnswerOrder, AskFacts, AskTransition, TellReaction
from domain.computers import SUPERVISOR, ComputerName, DeviceState, Incarnation
from domain.inputs import NodeAnswer, NodeReport, ReactionReport, SupervisorStatus
from domain.lifecycle import LifecycleState, Transition
from domain.link.device_link import DeviceLink
from domain.link.drops import Drop
from domain.link.messages import Beat, NodeOrder, Report
from domain.reaction_terms import ReactionState
from domain.timebase import seconds
from tests.support.linked_pair import (
    ARM,
    BASE,
    DRIVE,
    GRIPPER,
    TERMS,
    LinkedRobot,
    Process,
)

S = LifecycleState


def connected() -> LinkedRobot:
    robot = LinkedRobot()
    robot.run(1)
    return robot


def session(process: Process) -> str:
    assert isinstance(process.machine, DeviceLink)
    return process.machine.session


def an_order(robot: LinkedRobot, seq: int = 50) -> NodeOrder:
    """Return a command as the supervisor would send it now."""
    incarnation = robot.supervisor.machine.peers.own.incarnation
    assert isinstance(robot.base.machine, DeviceLink)
    command = AskTransition(700 + seq, DRIVE, Transition.CONFIGURE)
    heard_seq = robot.supervisor.machine.peers[BASE].heard_seq
    session = robot.base.machine.session
    return NodeOrder(SUPERVISOR, incarnation, seq, session, command, heard_seq)


# --- whom it follows -----------------------------------------------------------------------------


def test_a_device_follows_the_supervisor_that_hears_it() -> None:
    robot = connected()
    incarnation = robot.supervisor.machine.peers.own.incarnation

    assert robot.base.status() == SupervisorStatus(DeviceState.CONNECTED, "", incarnation)


def test_a_device_that_hears_nobody_says_nothing_to_its_core() -> None:
    robot = LinkedRobot()
    robot.kill(robot.supervisor)
    robot.run(10)

    assert robot.base.inputs == []


def test_a_second_supervisor_is_refused_and_told_while_the_first_is_there() -> None:
    robot = connected()
    second = robot.start(SUPERVISOR)
    robot.run(5)

    assert second.status().state is DeviceState.CONFLICT
    assert second.status().reason == (
        "device base refuses this computer: another supervisor is followed"
    )
    robot.order(process=second)
    assert second.answers[0].accepted is False
    robot.order()
    robot.run(0.1)
    assert len(robot.base.orders) == 1
    assert robot.supervisor.status().state is DeviceState.CONNECTED


def test_a_second_supervisor_is_followed_once_the_first_was_silent_for_long_enough() -> None:
    robot = connected()
    robot.kill(robot.supervisor)
    robot.run(0.1)
    second = robot.start(SUPERVISOR)
    robot.run(2)

    assert [state for _, state in robot.base.statuses] == ["connected", "late", "lost", "connected"]
    assert robot.base.status().incarnation == second.machine.peers.own.incarnation
    assert second.status().state is DeviceState.CONNECTED
    assert second.reports()[-1][0] < 1.1 + 2, "all is known within 2 s of its start"
    assert robot.orders_sent() == [], "it commands nothing by itself"


def test_a_supervisor_with_another_model_is_not_followed() -> None:
    robot = LinkedRobot()
    robot.kill(robot.supervisor)
    robot.start(SUPERVISOR, replace(TERMS, ownership="p"))
    robot.run(2)

    assert robot.base.status().reason == (
        "the supervisor is not dealt with: its robot file gives the devices other parts or times"
    )


# --- its session ---------------------------------------------------------------------------------


def test_the_session_is_another_one_after_each_loss() -> None:
    robot = connected()
    first = session(robot.base)
    robot.cut(SUPERVISOR, BASE)
    robot.run(1.3)
    late = session(robot.base)
    robot.run(0.3)
    lost = session(robot.base)
    robot.run(5)

    assert late == first
    assert lost not in (first, None)
    assert session(robot.base) == lost, "a loss is one event"


def test_the_session_is_another_one_if_only_the_supervisor_noticed_the_loss() -> None:
    robot = LinkedRobot.out_of_step()
    first = session(robot.base)
    robot.way(BASE, SUPERVISOR).is_cut = True
    robot.run(1.41)
    noticed = [process.statuses[-1][1] for process in (robot.supervisor, robot.base)]
    robot.way(BASE, SUPERVISOR).is_cut = False
    # What is pressed is told at once, and so is what is heard by then.
    robot.engage(robot.base, "b1")
    robot.run(0.01)
    robot.engage(robot.supervisor, "s1")
    robot.run(1)

    assert noticed == ["lost", "late"]
    assert session(robot.base) != first
    assert robot.supervisor.status().session == session(robot.base)  # type: ignore[union-attr]
    assert robot.supervisor.statuses[-1][1] == "connected"
    assert "lost" not in [state for _, state in robot.base.statuses]


# --- commands ------------------------------------------------------------------------------------


def test_a_command_goes_to_the_core_and_the_answer_back_under_the_same_number() -> None:
    robot = connected()
    request = robot.order()
    robot.run(0.01)
    robot.tell(robot.base, AnswerOrder(request, DRIVE, accepted=False, reason="jammed"))
    robot.run(0.01)

    assert robot.base.orders == [AskTransition(request, DRIVE, Transition.CONFIGURE)]
    assert robot.supervisor.answers == [NodeAnswer(request, DRIVE, False, "jammed")]


def test_a_command_that_arrives_twice_is_carried_out_once_and_not_answered_with_no() -> None:
    robot = connected()
    for _ in range(2):
        robot.hand(robot.base, SUPERVISOR, an_order(robot))
    robot.run(0.1)

    assert len(robot.base.orders) == 1
    assert robot.supervisor.answers == []
    assert robot.base.machine.drops.counts[Drop.OLD] == 1


def test_a_command_of_before_the_cut_is_refused_and_the_supervisor_told() -> None:
    robot = connected()
    robot.cut(SUPERVISOR, BASE, keeps=True)
    request = robot.order()
    robot.run(3)
    robot.mend(SUPERVISOR, BASE)
    robot.run(1)

    assert robot.base.orders == []
    assert robot.base.machine.drops.counts[Drop.REFUSED] == 1
    assert robot.supervisor.status().state is DeviceState.CONNECTED
    assert request == 1


def test_a_command_of_an_earlier_session_is_answered_with_its_reason() -> None:
    robot = connected()
    before = an_order(robot)
    robot.cut(SUPERVISOR, BASE)
    robot.run(3)
    robot.mend(SUPERVISOR, BASE)
    robot.run(1)
    robot.hand(robot.base, SUPERVISOR, before)
    robot.run(0.1)

    reason = "it was sent before the connection to the supervisor was lost"
    assert robot.supervisor.answers == [NodeAnswer(750, DRIVE, False, reason)]


def test_a_command_that_was_held_up_while_beats_got_through_is_refused() -> None:
    robot = connected()
    robot.way(SUPERVISOR, BASE).order_delay = seconds(1)
    robot.order()
    robot.run(1.1)
    in_time = len(robot.base.orders)
    robot.way(SUPERVISOR, BASE).order_delay = seconds(2)
    request = robot.order()
    robot.run(2.1)

    assert in_time == len(robot.base.orders) == 1
    reason = "it was on its way for too long"
    assert robot.supervisor.answers == [NodeAnswer(request, DRIVE, False, reason)]


def test_while_it_is_cut_off_it_carries_out_no_command() -> None:
    robot = connected()
    robot.cut(SUPERVISOR, BASE)
    robot.run(3)
    robot.hand(robot.base, SUPERVISOR, an_order(robot))

    assert robot.base.orders == []


def test_a_command_that_gets_through_where_beats_do_not_is_refused_once_it_is_lost() -> None:
    robot = LinkedRobot.out_of_step()
    robot.way(SUPERVISOR, BASE).loses_beats = True
    robot.run(1.46)
    request = robot.order()
    robot.run(0.01)

    assert [process.statuses[-1][1] for process in (robot.supervisor, robot.base)] == [
        "late",
        "lost",
    ]
    assert robot.orders_sent()[-1].command.request == request
    assert robot.base.orders == []


def test_a_young_command_of_before_the_loss_is_refused_after_the_return() -> None:
    robot = connected()
    way = robot.way(SUPERVISOR, BASE)
    way.loses_beats, way.order_delay = True, seconds(1)
    robot.run(1.3)
    robot.order()
    robot.run(0.3)
    way.loses_beats = False
    robot.run(0.65)
    is_back = robot.base.status().state
    robot.run(0.2)

    assert is_back is DeviceState.CONNECTED
    assert robot.base.orders == []
    assert robot.base.machine.drops.counts[Drop.REFUSED] == 1


def test_a_command_for_another_node_is_refused() -> None:
    robot = connected()
    order = an_order(robot)
    robot.hand(robot.base, SUPERVISOR, replace(order, command=AskFacts(3, GRIPPER)))

    assert robot.base.orders == []
    assert robot.base.machine.drops.counts[Drop.REFUSED] == 1


def test_a_command_of_another_supervisor_is_not_even_answered() -> None:
    robot = connected()
    robot.hand(robot.base, SUPERVISOR, replace(an_order(robot), incarnation=Incarnation("2")))
    robot.run(0.1)

    assert robot.base.orders == []
    assert robot.supervisor.answers == []


def test_an_answer_to_a_command_of_an_earlier_supervisor_goes_to_nobody() -> None:
    robot = connected()
    request = robot.order()
    robot.run(0.01)
    robot.kill(robot.supervisor)
    second = robot.start(SUPERVISOR)
    robot.run(4)
    robot.tell(robot.base, AnswerOrder(request, DRIVE, accepted=False))
    robot.run(1)

    assert second.status().state is DeviceState.CONNECTED
    assert second.answers == []


def test_another_device_commands_nothing() -> None:
    robot = LinkedRobot((BASE, ARM))
    robot.run(1)
    robot.hand(robot.base, ARM, replace(an_order(robot), sender=ARM))

    assert robot.base.orders == []
    assert robot.base.machine.drops.counts[Drop.UNEXPECTED] == 1


def test_what_says_to_be_from_somebody_else_is_dropped() -> None:
    robot = LinkedRobot((BASE, ARM))
    robot.run(1)
    robot.hand(robot.base, ARM, an_order(robot))
    robot.hand(robot.base, BASE, replace(an_order(robot), sender=BASE))

    assert robot.base.orders == []
    assert robot.base.machine.drops.counts[Drop.SENDER] == 2


# --- what it tells -------------------------------------------------------------------------------


def test_it_tells_of_its_own_parts_only_and_no_answers_of_nodes() -> None:
    robot = connected()
    before = len(robot.sent)
    robot.note(NodeReport(GRIPPER, S.ACTIVE))
    robot.note(NodeAnswer(1, DRIVE, True))
    robot.run(0.001)

    assert not any(isinstance(message, Report) for _, _, message in robot.sent[before:])


def test_it_tells_at_once_how_a_reaction_stands_and_again_after_a_cut() -> None:
    robot = connected()
    acting, idle = ReactionState.ACTING, ReactionState.IDLE
    robot.tell(robot.base, TellReaction(DRIVE, "COOL", acting))
    robot.run(0.01)
    robot.cut(BASE, SUPERVISOR)
    robot.run(2)
    robot.tell(robot.base, TellReaction(DRIVE, "COOL", idle))
    robot.mend(BASE, SUPERVISOR)
    robot.run(1)

    assert [given for _, given in robot.supervisor.inputs if isinstance(given, ReactionReport)] == [
        ReactionReport(DRIVE, "COOL", acting),
        ReactionReport(DRIVE, "COOL", idle),
    ]


def test_it_tells_nobody_who_does_not_hear_it() -> None:
    robot = LinkedRobot()
    robot.kill(robot.supervisor)
    robot.run(2)
    robot.note(NodeReport(DRIVE, S.ACTIVE))
    robot.run(2)

    assert {type(message) for _, _, message in robot.sent} == {Beat}


def test_it_tells_at_once_that_it_acts_alone_and_no_longer() -> None:
    robot = connected()
    before = len(robot.sent)
    robot.tell(robot.base, ActAlone(autonomous=False))
    unchanged = len(robot.sent)
    robot.tell(robot.base, ActAlone(autonomous=True))

    assert unchanged == before
    (_, to, beat) = robot.sent[-1]
    assert isinstance(beat, Beat)
    assert (to, beat.autonomous) == (SUPERVISOR, True)


def test_commands_for_nodes_are_none_of_the_link() -> None:
    robot = connected()
    before = len(robot.sent)
    robot.tell(robot.base, AskFacts(1, DRIVE))

    assert len(robot.sent) == before


def test_many_strangers_are_bounded() -> None:
    robot = connected()
    beat = next(message for _, _, message in robot.sent if isinstance(message, Beat))
    for number in range(20):
        name = ComputerName(f"x{number}")
        robot.hand(robot.base, name, replace(beat, sender=name))

    assert len(list(robot.base.machine.peers)) == 9
    assert robot.base.machine.drops.counts[Drop.SENDER] == 12


def test_after_a_long_pause_of_its_own_process_old_commands_do_not_count() -> None:
    robot = connected()
    order = an_order(robot)
    # The process was stopped, and everything waits in its queue.
    robot.now += seconds(5)
    robot.hand(robot.base, SUPERVISOR, order)

    assert robot.base.orders == []
    assert robot.base.status().state is DeviceState.LOST
