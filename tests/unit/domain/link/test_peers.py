"""Emergency stops and their release between computers, told as what happens to a robot."""

from dataclasses import replace

from domain.commands import AskRelease
from domain.computers import SUPERVISOR, ComputerName, DeviceState, StopId
from domain.inputs import PeerStops, StopsReleased
from domain.link.messages import Beat
from domain.timebase import seconds
from tests.support.linked_pair import ARM, BASE, TERMS, LinkedRobot, Process


def connected() -> LinkedRobot:
    robot = LinkedRobot((BASE, ARM))
    robot.run(2)
    return robot


def released(process: Process) -> list[StopsReleased]:
    return [given for _, given in process.inputs if isinstance(given, StopsReleased)]


def ask(robot: LinkedRobot, at: Process, of: ComputerName, *stops: str) -> None:
    robot.tell(at, AskRelease(of, tuple(StopId(stop) for stop in stops)))


# --- engaged -------------------------------------------------------------------------------------


def test_a_stop_is_known_to_every_computer_at_once() -> None:
    robot = connected()
    robot.engage(robot.base, "b1")
    robot.run(0.002)

    assert robot.supervisor.stops_of(BASE) == {"b1"}
    assert robot.devices[ARM].stops_of(BASE) == {"b1"}


def test_a_beat_that_is_lost_delays_a_stop_by_one_beat_also_between_devices() -> None:
    robot = connected()
    for to in (SUPERVISOR, ARM):
        robot.way(BASE, to).is_cut = True
    robot.engage(robot.base, "b1")
    for to in (SUPERVISOR, ARM):
        robot.way(BASE, to).is_cut = False
    robot.run(0.102)

    assert robot.supervisor.stops_of(BASE) == {"b1"}
    assert robot.devices[ARM].stops_of(BASE) == {"b1"}
    robot.run(0.6)
    (peer,) = (peer for peer in robot.base.machine.peers if peer.name == ARM)
    assert peer.has_acknowledged


def test_a_stop_is_given_to_the_core_once_and_again_when_it_ends() -> None:
    robot = connected()
    robot.run(1)
    before = len(robot.supervisor.inputs)
    robot.engage(robot.base, "b1")
    robot.run(5)
    robot.engage(robot.base)
    robot.run(5)

    told = [
        [stop.id for stop in given.stops]
        for _, given in robot.supervisor.inputs[before:]
        if isinstance(given, PeerStops) and given.computer == BASE
    ]
    assert told == [["b1"], []]


def test_a_stop_holds_while_its_computer_cannot_be_heard() -> None:
    robot = connected()
    robot.engage(robot.base, "b1")
    robot.run(0.1)
    robot.cut(SUPERVISOR, BASE)
    robot.run(60)

    assert robot.supervisor.stops_of(BASE) == {"b1"}


def test_a_stop_that_is_engaged_during_a_cut_is_known_after_it() -> None:
    robot = connected()
    robot.cut(SUPERVISOR, BASE)
    robot.run(3)
    robot.engage(robot.base, "b1")
    robot.run(3)
    robot.mend(SUPERVISOR, BASE)
    robot.run(0.5)

    assert robot.supervisor.stops_of(BASE) == {"b1"}
    assert robot.supervisor.status().state is DeviceState.CONNECTED


def test_devices_stop_each_other_without_a_supervisor() -> None:
    robot = LinkedRobot((BASE, ARM))
    robot.kill(robot.supervisor)
    robot.run(2)
    robot.engage(robot.base, "b1")
    robot.run(0.002)

    assert robot.devices[ARM].stops_of(BASE) == {"b1"}


def test_a_stop_is_taken_from_a_device_with_another_model() -> None:
    robot = LinkedRobot((BASE, ARM))
    robot.kill(robot.base)
    other = robot.start(BASE, replace(TERMS, model="n"))
    robot.engage(other, "b1")
    robot.run(2)

    assert robot.supervisor.status().state is DeviceState.CONFLICT
    assert robot.supervisor.stops_of(BASE) == {"b1"}


def test_a_stop_is_taken_from_a_newcomer_that_is_refused_and_it_releases_no_other() -> None:
    robot = connected()
    robot.engage(robot.base, "b1")
    newcomer = robot.start(BASE)
    robot.engage(newcomer, "n1")
    robot.run(3)
    both = robot.supervisor.stops_of(BASE)
    robot.engage(newcomer)
    robot.run(1)

    assert both == {"b1", "n1"}
    assert robot.supervisor.stops_of(BASE) == {"b1"}


def test_a_stop_is_taken_from_whom_the_robot_file_does_not_have() -> None:
    robot = LinkedRobot((BASE,))
    stranger = robot.start(ARM)
    robot.engage(stranger, "x1")
    robot.run(1)
    robot.kill(stranger)
    robot.run(10)
    held = robot.supervisor.stops_of(ARM)
    ask(robot, robot.supervisor, ARM, "x1")
    robot.run(1)

    assert held == {"x1"}
    assert robot.supervisor.stops_of(ARM) == set()
    assert [peer.name for peer in robot.supervisor.machine.peers] == [BASE]


def test_what_an_earlier_run_knew_of_a_computer_ends_once_all_who_live_could_be_heard() -> None:
    robot = LinkedRobot((BASE,))
    robot.engage(robot.base, "b2")
    robot.run(3)

    told = [(at, given) for at, given in robot.supervisor.inputs if isinstance(given, PeerStops)]
    (first, _), (connected_at, _), (whole_at, _) = told
    assert first <= connected_at < seconds(0.3)
    assert seconds(1.5) <= whole_at < seconds(1.7)
    assert [given.is_dealt_with for _, given in told] == [False, True, True]
    assert [given.ended for _, given in told] == [(), (), None]


def test_a_second_supervisor_is_heard_before_what_an_earlier_run_knew_of_its_stop_ends() -> None:
    robot = LinkedRobot((BASE,))
    robot.kill(robot.base)
    other = robot.start(SUPERVISOR)
    robot.engage(other, "s9")
    robot.run(3)
    other.is_hidden = True
    base = robot.start(BASE)
    robot.run(1.2)
    is_connected = base.status().state is DeviceState.CONNECTED
    other.is_hidden = False
    robot.run(5)

    told = [given for _, given in base.inputs if isinstance(given, PeerStops)]
    (whole,) = (given for given in told if given.ended is None)
    assert is_connected
    assert [stop.id for stop in whole.stops] == ["s9"]


def test_a_device_that_is_not_dealt_with_releases_its_own_stop() -> None:
    robot = LinkedRobot((BASE,))
    robot.kill(robot.base)
    other = robot.start(BASE, replace(TERMS, model="n"))
    robot.engage(other, "b1")
    robot.run(2)
    robot.engage(other)
    robot.run(1)

    told = [given for _, given in robot.supervisor.inputs if isinstance(given, PeerStops)]
    assert [(len(given.stops), given.ended) for given in told] == [(1, ()), (0, ("b1",))]


# --- a computer that starts again ----------------------------------------------------------------


def test_a_stop_that_the_store_brought_back_is_the_same_one() -> None:
    robot = connected()
    robot.engage(robot.base, "b1")
    robot.run(0.1)
    robot.kill(robot.base)
    again = robot.start(BASE)
    robot.engage(again, "b1")
    robot.run(5)

    assert robot.supervisor.stops_of(BASE) == {"b1"}
    ask(robot, robot.supervisor, BASE, "b1")
    robot.run(0.1)
    assert released(again) == [StopsReleased((StopId("b1"),), SUPERVISOR)]


def test_a_stop_that_the_store_brought_back_ends_at_the_new_process_for_all() -> None:
    robot = connected()
    robot.engage(robot.base, "b1")
    robot.run(0.1)
    robot.kill(robot.base)
    again = robot.start(BASE)
    robot.engage(again, "b1")
    robot.run(5)
    robot.engage(again)
    robot.run(1)

    assert robot.supervisor.stops_of(BASE) == set()
    assert robot.devices[ARM].stops_of(BASE) == set()


def test_a_stop_that_the_store_lost_stays_until_a_person_names_it() -> None:
    robot = connected()
    robot.engage(robot.base, "b1")
    robot.run(0.1)
    robot.kill(robot.base)
    robot.run(0.2)
    robot.start(BASE)
    robot.run(5)
    before = robot.supervisor.stops_of(BASE), robot.devices[ARM].stops_of(BASE)

    ask(robot, robot.supervisor, BASE, "b1")
    robot.run(2)

    assert before == ({"b1"}, {"b1"})
    assert robot.supervisor.stops_of(BASE) == set()
    assert robot.devices[ARM].stops_of(BASE) == set()


def test_a_stop_of_the_supervisor_that_its_store_lost_ends_once_it_is_dealt_with() -> None:
    robot = connected()
    robot.engage(robot.supervisor, "s1")
    robot.run(0.1)
    robot.kill(robot.supervisor)
    robot.run(0.2)
    robot.start(SUPERVISOR)
    robot.run(5)

    assert robot.base.stops_of(SUPERVISOR) == set()


def test_the_stop_of_a_device_that_is_hidden_stays_when_another_process_takes_its_name() -> None:
    robot = connected()
    hidden = robot.base
    robot.engage(hidden, "b1")
    robot.run(0.1)
    robot.hide(hidden)
    robot.run(3)
    robot.start(BASE)
    robot.run(5)
    assert robot.supervisor.stops_of(BASE) == {"b1"}
    assert robot.devices[ARM].stops_of(BASE) == {"b1"}

    robot.show(hidden)
    robot.run(3)
    assert robot.supervisor.stops_of(BASE) == {"b1"}
    robot.engage(hidden)
    robot.run(1)
    assert robot.supervisor.stops_of(BASE) == set()
    assert robot.devices[ARM].stops_of(BASE) == set()


def test_a_newcomer_that_lives_keeps_its_stop_however_soon_it_came() -> None:
    robot = LinkedRobot((BASE, ARM))
    robot.run(0.15)
    newcomer = robot.start(BASE)
    robot.engage(newcomer, "n1")
    robot.run(10)

    assert robot.supervisor.stops_of(BASE) == {"n1"}
    robot.kill(newcomer)
    robot.run(10)
    assert robot.supervisor.stops_of(BASE) == {"n1"}


def test_a_process_that_nobody_hears_any_more_and_that_was_refused_is_released_by_name() -> None:
    robot = connected()
    newcomer = robot.start(BASE)
    robot.engage(newcomer, "n1", "n2")
    robot.run(3)
    ask(robot, robot.supervisor, BASE, "n1")
    robot.run(1)
    while_it_is_heard = robot.supervisor.stops_of(BASE)
    robot.kill(newcomer)
    robot.run(5)
    ask(robot, robot.supervisor, BASE, "n1")
    robot.run(1)

    assert while_it_is_heard == {"n1", "n2"}
    assert robot.supervisor.stops_of(BASE) == {"n2"}


# --- released ------------------------------------------------------------------------------------


def test_a_release_names_what_its_person_saw_and_is_told_once() -> None:
    robot = connected()
    robot.engage(robot.base, "b1", "b2")
    robot.run(1)
    ask(robot, robot.supervisor, BASE, "b1", "b9")
    robot.run(1)

    assert released(robot.base) == [StopsReleased((StopId("b1"),), SUPERVISOR)]
    robot.engage(robot.base, "b2")
    robot.run(1)
    assert robot.supervisor.stops_of(BASE) == {"b2"}
    beats = [message for _, to, message in robot.sent if to == BASE and isinstance(message, Beat)]
    assert beats[-1].releases == ()


def test_a_device_can_release_a_stop_of_the_supervisor_and_of_another_device() -> None:
    robot = connected()
    robot.engage(robot.supervisor, "s1")
    robot.engage(robot.devices[ARM], "a1")
    robot.run(1)
    ask(robot, robot.base, SUPERVISOR, "s1")
    ask(robot, robot.base, ARM, "a1")
    robot.run(1)

    assert released(robot.supervisor) == [StopsReleased((StopId("s1"),), BASE)]
    assert released(robot.devices[ARM]) == [StopsReleased((StopId("a1"),), BASE)]


def test_a_release_that_is_lost_is_repeated() -> None:
    robot = connected()
    robot.engage(robot.base, "b1")
    robot.run(0.1)
    robot.way(SUPERVISOR, BASE).is_cut = True
    ask(robot, robot.supervisor, BASE, "b1")
    robot.run(0.3)
    robot.way(SUPERVISOR, BASE).is_cut = False
    robot.run(0.2)

    assert len(released(robot.base)) == 1


def test_a_release_does_not_outlive_the_connection() -> None:
    robot = connected()
    robot.engage(robot.base, "b1")
    robot.run(0.1)
    robot.cut(SUPERVISOR, BASE, keeps=True)
    ask(robot, robot.supervisor, BASE, "b1")
    robot.run(3)
    ask(robot, robot.supervisor, BASE, "b1")
    robot.run(30)
    robot.mend(SUPERVISOR, BASE)
    robot.run(3)

    assert released(robot.base) == []
    assert robot.supervisor.stops_of(BASE) == {"b1"}
    ask(robot, robot.supervisor, BASE, "b1")
    robot.run(0.1)
    assert len(released(robot.base)) == 1


def test_who_is_not_dealt_with_releases_nothing() -> None:
    robot = connected()
    robot.engage(robot.base, "b1")
    robot.run(0.1)
    beat = next(m for _, to, m in robot.sent if to == BASE and isinstance(m, Beat))
    second = replace(beat, incarnation=robot.new_id(), releases=(StopId("b1"),))  # type: ignore[arg-type]
    robot.hand(robot.base, SUPERVISOR, second)
    other = replace(second, incarnation=robot.new_id(), terms=replace(TERMS, model="n"))  # type: ignore[arg-type]
    robot.hand(robot.base, SUPERVISOR, other)

    assert released(robot.base) == []


def test_an_unknown_computer_cannot_be_asked() -> None:
    robot = connected()
    before = len(robot.sent)
    ask(robot, robot.supervisor, ComputerName("mast"), "m1")

    assert len(robot.sent) == before
