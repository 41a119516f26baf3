"""The supervisor's end of the link, told as what happens to a robot of two computers."""

from dataclasses import replace

import pytest

from domain.commands import ActAlone, AskFacts
from domain.computers import SUPERVISOR, ComputerName, DeviceState, Incarnation
from domain.inputs import DeviceStatus, NodeAnswer, NodeReport, Reading, Readings
from domain.lifecycle import LifecycleState
from domain.link.drops import Drop
from domain.link.messages import Beat, NodeOrder, Report
from domain.link.supervisor_link import SupervisorLink
from domain.state_and_mode import PartName
from domain.timebase import seconds
from tests.support.linked_pair import (
    ARM,
    BASE,
    DRIVE,
    GRIPPER,
    TERMS,
    UNCONFIGURED,
    LinkedRobot,
    Process,
)

S = LifecycleState
ACTIVE = NodeReport(DRIVE, S.ACTIVE)


def connected() -> LinkedRobot:
    robot = LinkedRobot()
    robot.run(1)
    return robot


def settled() -> LinkedRobot:
    """Return a robot all of whose computers could be heard since the start."""
    robot = LinkedRobot()
    robot.run(3)
    return robot


def drops(process: Process, why: Drop) -> int:
    return process.machine.drops.counts[why]


def last_states(robot: LinkedRobot, number: int) -> list[str]:
    return [state for _, state in robot.supervisor.statuses[-number:]]


# --- the first contact ---------------------------------------------------------------------------


def test_a_device_is_connected_together_with_all_that_is_known_of_it() -> None:
    robot = connected()
    told = [
        (at, given)
        for at, given in robot.supervisor.inputs
        if isinstance(given, NodeReport | DeviceStatus)
    ]

    (reported, report), (connected_at, status) = told
    assert report == UNCONFIGURED
    assert isinstance(status, DeviceStatus)
    assert (status.state, status.version, status.reason) == (DeviceState.CONNECTED, "1.2.0", "")
    assert reported == connected_at <= seconds(0.3)


def test_a_device_that_is_not_there_is_missing_once_it_could_have_been_heard() -> None:
    robot = LinkedRobot()
    robot.kill(robot.base)
    robot.run(1.4)
    before = list(robot.supervisor.inputs)
    robot.run(5)

    status = DeviceStatus(BASE, DeviceState.NEVER_SEEN, "device base has not been heard yet")
    gone = NodeReport(DRIVE, reachable=False)
    assert before == []
    assert robot.supervisor.inputs == [(seconds(1.5), status), (seconds(1.5), gone)]


def test_a_node_of_which_the_device_knows_nothing_keeps_nobody_from_connecting() -> None:
    robot = LinkedRobot()
    robot.kill(robot.base)
    fresh = robot.start(BASE)
    robot.run(5)

    assert robot.supervisor.status().state is DeviceState.CONNECTED
    assert robot.supervisor.status().incarnation == fresh.machine.peers.own.incarnation


# --- what a device tells -------------------------------------------------------------------------


def test_what_changes_is_known_at_once() -> None:
    robot = connected()
    robot.note(ACTIVE)
    robot.run(0.01)

    assert robot.supervisor.reports()[-1][1] == ACTIVE


def test_a_lost_message_is_mended_within_a_second() -> None:
    robot = connected()
    robot.way(BASE, SUPERVISOR).is_cut = True
    robot.note(ACTIVE)
    robot.run(0.01)
    robot.way(BASE, SUPERVISOR).is_cut = False
    known_before = robot.supervisor.reports()[-1][1]
    robot.run(1)

    assert known_before == UNCONFIGURED
    assert robot.supervisor.reports()[-1][1] == NodeReport(DRIVE, S.ACTIVE)


def test_while_nothing_changes_the_core_is_given_nothing() -> None:
    robot = settled()
    before = len(robot.supervisor.inputs)
    robot.run(20)

    assert len(robot.supervisor.inputs) == before


def test_a_device_cannot_speak_for_the_nodes_and_signals_of_another() -> None:
    robot = LinkedRobot((BASE, ARM))
    robot.run(1)
    of_arm = robot.supervisor.reports(GRIPPER)
    session = robot.supervisor.status().session  # type: ignore[union-attr]
    incarnation = robot.base.machine.peers.own.incarnation
    told = (NodeReport(GRIPPER, S.FINALIZED), Readings((Reading("estop", False),), "x"), ACTIVE)
    robot.hand(robot.supervisor, BASE, Report(BASE, incarnation, 99, told, session=session))

    assert robot.supervisor.reports(GRIPPER) == of_arm
    assert robot.supervisor.inputs[-1][1] == ACTIVE


@pytest.mark.parametrize("reused", ["seq", "session", "incarnation"])
def test_what_is_out_of_date_is_dropped_and_counted(reused: str) -> None:
    robot = connected()
    session = robot.supervisor.status().session  # type: ignore[union-attr]
    incarnation = robot.base.machine.peers.own.incarnation
    good = Report(BASE, incarnation, 99, (ACTIVE,), session=session)
    bad = {
        "seq": replace(good, seq=1),
        "session": replace(good, session=None),
        "incarnation": replace(good, incarnation=Incarnation("0")),
    }[reused]
    robot.hand(robot.supervisor, BASE, bad)

    assert robot.supervisor.reports()[-1][1] == UNCONFIGURED
    assert drops(robot.supervisor, Drop.OLD) == 1
    robot.hand(robot.supervisor, BASE, good)
    assert robot.supervisor.reports()[-1][1] == ACTIVE


def test_that_a_device_acts_alone_is_known_while_it_is_heard() -> None:
    robot = connected()
    robot.tell(robot.base, ActAlone(autonomous=True))
    robot.run(0.01)

    assert robot.supervisor.status().autonomous  # type: ignore[union-attr]


# --- commands ------------------------------------------------------------------------------------


def test_a_command_goes_to_the_device_of_the_node_under_its_session() -> None:
    robot = LinkedRobot((BASE, ARM))
    robot.run(1)
    robot.order(GRIPPER)
    robot.run(0.01)

    assert [command.node for command in robot.devices[ARM].orders] == [GRIPPER]
    assert robot.base.orders == []


def test_a_command_for_a_device_that_is_late_still_goes_out() -> None:
    robot = connected()
    robot.cut(SUPERVISOR, BASE)
    robot.run(0.8)
    robot.order()

    assert robot.supervisor.status().state is DeviceState.LATE
    assert robot.supervisor.status().reason == "device base has not been heard for 0.5 s"
    assert len(robot.orders_sent()) == 1


def test_a_command_for_a_device_that_is_lost_is_answered_with_no_at_once() -> None:
    robot = connected()
    robot.cut(SUPERVISOR, BASE)
    robot.run(2)
    request = robot.order()

    assert robot.orders_sent() == []
    assert robot.supervisor.answers == [
        NodeAnswer(request, DRIVE, False, "device base has not been heard for 2.0 s")
    ]


def test_a_command_for_a_node_of_no_device_is_answered_with_no() -> None:
    robot = connected()
    robot.tell(robot.supervisor, AskFacts(7, PartName("mast")))

    assert robot.supervisor.answers == [
        NodeAnswer(7, PartName("mast"), False, "no device has such a node")
    ]


# --- cut, and back -------------------------------------------------------------------------------


def test_a_device_is_late_and_then_lost_and_its_nodes_are_unreachable_after_it() -> None:
    robot = connected()
    robot.cut(SUPERVISOR, BASE)
    robot.run(3)

    (late_at, late), (lost_at, lost) = robot.supervisor.statuses[-2:]
    assert (late, lost) == ("late", "lost")
    assert late_at <= 1.7
    assert lost_at <= 2.8
    assert [given for _, given in robot.supervisor.inputs[-2:]] == [
        robot.supervisor.status(),
        NodeReport(DRIVE, reachable=False),
    ]
    assert robot.supervisor.status().reason == "device base has not been heard for 1.4 s"


def test_a_device_that_is_back_is_known_at_one_moment() -> None:
    robot = settled()
    robot.cut(SUPERVISOR, BASE)
    robot.run(3)
    robot.note(ACTIVE)
    robot.mend(SUPERVISOR, BASE)
    before = len(robot.supervisor.inputs)
    robot.run(5)

    since = robot.supervisor.inputs[before:]
    assert [type(given) for _, given in since] == [NodeReport, DeviceStatus]
    assert since[0][1] == NodeReport(DRIVE, S.ACTIVE, reachable=True)
    assert since[0][0] == since[1][0] <= seconds(6.3)
    assert robot.supervisor.status().state is DeviceState.CONNECTED
    assert robot.supervisor.status().reason == ""


@pytest.mark.parametrize("way", [(SUPERVISOR, BASE), (BASE, SUPERVISOR)])
def test_a_cut_in_one_direction_is_noticed_on_both_ends(
    way: tuple[ComputerName, ComputerName],
) -> None:
    robot = connected()
    robot.way(*way).is_cut = True
    robot.run(2)

    for process in (robot.supervisor, robot.base):
        since = {state: at for at, state in reversed(process.statuses)}
        assert since["late"] <= 1.7
        assert since["lost"] <= 2.8
    robot.way(*way).is_cut = False
    robot.run(2)
    assert robot.supervisor.status().state is DeviceState.CONNECTED
    assert robot.base.status().state is DeviceState.CONNECTED


def test_a_delay_of_200_ms_both_ways_is_no_trouble() -> None:
    robot = LinkedRobot()
    for way in ((SUPERVISOR, BASE), (BASE, SUPERVISOR)):
        robot.way(*way).delay = seconds(0.2)
    robot.run(20)

    assert [state for _, state in robot.supervisor.statuses] == ["connected"]
    assert [state for _, state in robot.base.statuses] == ["connected"]


def test_what_arrives_only_after_the_cut_connects_nobody_and_says_nothing() -> None:
    robot = settled()
    robot.cut(SUPERVISOR, BASE, keeps=True)
    robot.note(ACTIVE)
    robot.run(3)
    robot.note(replace(ACTIVE, state=S.INACTIVE))
    robot.mend(SUPERVISOR, BASE)
    before = len(robot.supervisor.inputs)
    robot.run(3)

    since = [given for _, given in robot.supervisor.inputs[before:]]
    assert since[0] == NodeReport(DRIVE, S.INACTIVE, reachable=True)
    assert len(since) == 2


def test_a_device_that_lost_us_alone_stays_connected_under_its_new_session() -> None:
    robot = LinkedRobot.out_of_step()
    session = robot.supervisor.status().session  # type: ignore[union-attr]
    robot.way(SUPERVISOR, BASE).is_cut = True
    robot.run(1.46)
    robot.way(SUPERVISOR, BASE).is_cut = False
    # What is pressed is told at once, and so is what is heard by then.
    robot.engage(robot.supervisor, "s1")
    robot.run(0.01)
    robot.engage(robot.base, "b1")
    robot.run(2)
    robot.order()
    robot.run(0.1)

    assert "lost" in [state for _, state in robot.base.statuses]
    assert "lost" not in [state for _, state in robot.supervisor.statuses]
    assert robot.supervisor.status().session not in (None, session)  # type: ignore[union-attr]
    assert len(robot.base.orders) == 1


# --- several processes of one name ---------------------------------------------------------------


def test_a_device_that_is_killed_and_started_again_is_lost_and_then_known_as_new() -> None:
    robot = connected()
    first = robot.supervisor.status().incarnation
    robot.kill(robot.base)
    robot.run(0.3)
    robot.start(BASE)
    robot.run(2)

    assert last_states(robot, 3) == ["late", "lost", "connected"]
    assert robot.supervisor.status().incarnation != first
    (_, before), (_, gone), (_, after) = robot.supervisor.reports()
    assert (before, gone.reachable, after) == (UNCONFIGURED, False, UNCONFIGURED)


def test_of_two_processes_of_one_device_the_newcomer_is_refused_and_told() -> None:
    robot = connected()
    incumbent = robot.supervisor.status().incarnation
    newcomer = robot.start(BASE)
    robot.run(5)

    status = robot.supervisor.status()
    assert isinstance(status, DeviceStatus)
    assert (status.state, status.incarnation) == (DeviceState.CONNECTED, incumbent)
    assert status.refused == "another process is device base"
    assert newcomer.status().state is DeviceState.CONFLICT
    assert newcomer.status().reason == (
        "the supervisor refuses this computer: another process is device base"
    )
    robot.order()
    robot.run(0.1)
    assert (len(robot.base.orders), newcomer.orders) == (1, [])


def test_a_newcomer_that_gives_up_is_forgotten() -> None:
    robot = connected()
    newcomer = robot.start(BASE)
    robot.run(2)
    robot.kill(newcomer)
    robot.run(2)

    assert robot.supervisor.status().refused == ""  # type: ignore[union-attr]


def test_a_newcomer_takes_the_place_of_an_incumbent_that_dies() -> None:
    robot = connected()
    newcomer = robot.start(BASE)
    robot.run(2)
    robot.kill(robot.base)
    robot.run(2)

    status = robot.supervisor.status()
    assert isinstance(status, DeviceStatus)
    assert (status.state, status.refused) == (DeviceState.CONNECTED, "")
    assert status.incarnation == newcomer.machine.peers.own.incarnation
    assert newcomer.status().state is DeviceState.CONNECTED


def test_beats_of_a_dead_process_that_arrive_late_are_no_conflict() -> None:
    robot = connected()
    robot.way(BASE, SUPERVISOR).keeps = robot.way(BASE, SUPERVISOR).is_cut = True
    robot.run(0.5)
    robot.kill(robot.base)
    kept, robot.way(BASE, SUPERVISOR).kept = robot.way(BASE, SUPERVISOR).kept, []
    robot.way(BASE, SUPERVISOR).is_cut = False
    robot.start(BASE)
    robot.run(3)
    for message in kept:
        robot.hand(robot.supervisor, BASE, message)
    robot.run(1)

    status = robot.supervisor.status()
    assert isinstance(status, DeviceStatus)
    assert (status.state, status.refused) == (DeviceState.CONNECTED, "")


def test_a_device_with_another_model_is_not_dealt_with_and_both_say_so() -> None:
    robot = LinkedRobot()
    robot.kill(robot.base)
    other = robot.start(BASE, replace(TERMS, model="n"))
    robot.run(3)

    assert robot.supervisor.status().state is DeviceState.CONFLICT
    assert robot.supervisor.status().reason == (
        "device base is not dealt with: it runs another model"
    )
    assert other.status().state is DeviceState.CONFLICT
    assert robot.supervisor.reports() == [(1.5, NodeReport(DRIVE, reachable=False))]
    robot.kill(other)
    robot.run(2)
    assert robot.supervisor.status().state is DeviceState.NEVER_SEEN


# --- who may say what ----------------------------------------------------------------------------


def test_what_says_to_be_from_somebody_else_is_dropped_and_counted() -> None:
    robot = LinkedRobot((BASE, ARM))
    robot.run(1)
    beat = next(message for _, _, message in robot.sent if isinstance(message, Beat))
    robot.hand(robot.supervisor, ARM, replace(beat, sender=BASE))
    robot.hand(robot.supervisor, SUPERVISOR, replace(beat, sender=SUPERVISOR))

    assert drops(robot.supervisor, Drop.SENDER) == 2


def test_nobody_commands_the_supervisor() -> None:
    robot = connected()
    order = NodeOrder(BASE, Incarnation("i"), 1, "s", AskFacts(1, DRIVE))  # type: ignore[arg-type]
    robot.hand(robot.supervisor, BASE, order)

    assert drops(robot.supervisor, Drop.UNEXPECTED) == 1


def test_a_device_that_the_robot_file_does_not_have_is_refused_and_told() -> None:
    robot = LinkedRobot((BASE,))
    stranger = robot.start(ARM)
    robot.run(3)

    assert stranger.status().reason == (
        "the supervisor refuses this computer: the robot file has no such device"
    )
    robot.kill(stranger)
    robot.run(3)
    assert isinstance(robot.supervisor.machine, SupervisorLink)
    assert [peer.name for peer in robot.supervisor.machine.peers] == [BASE]


def test_many_strangers_are_bounded() -> None:
    robot = connected()
    beat = next(message for _, _, message in robot.sent if isinstance(message, Beat))
    for number in range(100):
        name = ComputerName(f"x{number}")
        robot.hand(robot.supervisor, name, replace(beat, sender=name))

    assert len(list(robot.supervisor.machine.peers)) == 9
    assert drops(robot.supervisor, Drop.SENDER) == 92
