from domain.computers import SUPERVISOR, ComputerName, PeerStop, StopId, StopView
from domain.health.engaged_stops import EngagedStops
from domain.timebase import Instant

ARM, BASE = ComputerName("arm"), ComputerName("base")
FIRST, SECOND, THIRD = StopId("a-1"), StopId("a-2"), StopId("b-1")


def stop(identity: StopId, since: Instant = 0) -> PeerStop:
    return PeerStop(identity, "ada", "a child", since)


def both(*, told: bool = True) -> EngagedStops:
    """Return stops of a robot with two devices: two on the arm, one on the base."""
    stops = EngagedStops((ARM, BASE))
    for computer in (ARM, BASE):
        if told:
            stops.note_told(computer)
    stops.add(ARM, stop(FIRST, 4))
    stops.add(ARM, stop(SECOND, 2))
    stops.add(BASE, stop(THIRD, 3))
    return stops


def test_a_robot_is_stopped_while_a_stop_is_engaged_anywhere() -> None:
    stops = EngagedStops((ARM,))
    assert not stops.is_any

    stops.own = stop(FIRST)
    stops.add(ARM, stop(SECOND))
    stops.own = None
    assert stops.is_any

    stops.remove(ARM, SECOND)
    assert not stops.is_any
    assert stops.stopping_peers == ()


def test_the_oldest_stop_is_shown_first() -> None:
    stops = both()
    stops.own = stop(StopId("own"), 3)

    assert [(view.computer, view.id) for view in stops.views()] == [
        (ARM, SECOND),
        (None, "own"),
        (BASE, THIRD),
        (ARM, FIRST),
    ]
    assert stops.views()[0] == StopView(SECOND, ARM, "ada", "a child", 2)


def test_each_computer_gives_one_reason_and_one_that_is_silent_is_said_to_be() -> None:
    stops = both()
    stops.own = stop(StopId("own"), 9)
    stops.add(SUPERVISOR, stop(StopId("s-1"), 7))
    stops.note_connection(ARM, is_heard=False)
    stops.note_connection(SUPERVISOR, is_heard=True)

    assert stops.causes() == (
        ("emergency stop is engaged", 9),
        ("emergency stop is engaged at device arm, which has not been heard", 2),
        ("emergency stop is engaged at device base", 3),
        ("emergency stop is engaged at the supervisor", 7),
    )


def test_a_peer_is_heard_once_it_told_its_stops_unless_the_link_knows_better() -> None:
    stops = EngagedStops((ARM, BASE))
    assert list(stops.not_heard) == [ARM, BASE]

    stops.note_told(ARM)
    assert list(stops.not_heard) == [BASE]

    stops.note_connection(ARM, is_heard=False)
    stops.note_told(ARM)
    assert list(stops.not_heard) == [ARM, BASE], "it cannot hear us, or is not dealt with"

    stops.note_connection(ARM, is_heard=True)
    assert list(stops.not_heard) == [BASE]


def test_only_peers_that_can_be_heard_are_asked_to_release() -> None:
    stops = both()
    assert stops.to_ask(None) == {ARM: (FIRST, SECOND), BASE: (THIRD,)}
    assert stops.to_ask((SECOND, StopId("gone"))) == {ARM: (SECOND,)}
    assert stops.to_ask(()) == {}

    stops.note_connection(ARM, is_heard=False)
    assert stops.to_ask(None) == {BASE: (THIRD,)}
    assert both(told=False).to_ask(None) == {}


def test_a_peer_is_waited_for_until_it_released_what_it_was_asked_to() -> None:
    stops = both()
    stops.note_asked(ARM, (FIRST,))
    stops.note_asked(ARM, (SECOND,))
    stops.remove(ARM, FIRST)
    assert list(stops.waited_for) == [ARM]

    stops.remove(ARM, SECOND)
    assert list(stops.waited_for) == []


def test_what_a_peer_was_asked_is_void_once_it_cannot_be_heard() -> None:
    stops = both()
    stops.note_asked(ARM, (FIRST,))

    stops.note_connection(ARM, is_heard=False)
    stops.note_connection(ARM, is_heard=True)

    assert list(stops.waited_for) == []
    assert FIRST in stops.of(ARM)
