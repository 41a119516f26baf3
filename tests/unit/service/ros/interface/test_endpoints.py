from collections.abc import Callable

from service.ros.interface.endpoints import Fields, Listeners


def test_all_who_listen_hear_and_nobody_else() -> None:
    listeners = Listeners()
    one: list[Fields] = []
    other: list[Fields] = []
    elsewhere: list[Fields] = []
    listeners.add("/a", one.append)
    listeners.add("/a", other.append)
    listeners.add("/b", elsewhere.append)

    listeners.send("/a", {"n": 1})

    assert (one, other, elsewhere) == ([{"n": 1}], [{"n": 1}], [])


def test_the_same_listener_may_listen_twice_and_stop_once() -> None:
    listeners = Listeners()
    heard: list[Fields] = []
    listeners.add("/a", heard.append)
    stop = listeners.add("/a", heard.append)

    stop()
    stop()
    listeners.send("/a", {"n": 1})

    assert heard == [{"n": 1}]


def test_a_topic_is_heard_until_the_last_one_stops() -> None:
    listeners = Listeners()
    stops = [listeners.add("/a", lambda _: None) for _ in range(2)]

    stops[0]()
    assert listeners.hears("/a")
    stops[1]()
    assert not listeners.hears("/a")


def test_who_stops_while_a_message_is_handed_out_disturbs_nobody() -> None:
    listeners = Listeners()
    stops: list[Callable[[], None]] = []
    heard: list[Fields] = []
    stops.append(listeners.add("/a", lambda _: stops[0]()))
    listeners.add("/a", heard.append)

    listeners.send("/a", {"n": 1})
    listeners.send("/a", {"n": 2})

    assert heard == [{"n": 1}, {"n": 2}]
