from api.cli.monitor.view import Contact, Level
from api.cli.monitor.watch import ServerClock, Watch, local_now
from tests.support.monitor import AT, URL, after, event, frame, graph, hello


class Time:
    """Local time in seconds since 1970, which a test moves."""

    def __init__(self) -> None:
        self.now_s = 1000.0

    def __call__(self) -> float:
        return self.now_s


def test_it_is_live_as_long_as_frames_come() -> None:
    time = Time()
    watch = Watch(URL, now=time)
    watch.take(frame())

    time.now_s += 2.9
    assert watch.contact() == Contact(Level.LIVE, time.now_s - 1000.0)
    time.now_s += 0.2
    assert watch.contact().level is Level.LOST


def test_it_is_live_as_long_as_a_graph_is_observed() -> None:
    watch = Watch(URL, now=Time())
    watch.take(graph())

    assert watch.contact() == Contact(Level.LIVE, 0.0)


def test_contact_that_broke_is_lost_at_once_with_the_reason() -> None:
    watch = Watch(URL, now=Time())
    watch.take(frame())

    watch.lose("the connection was lost")

    assert watch.contact() == Contact(Level.LOST, 0.0, "the connection was lost")


def test_with_the_next_frame_all_is_well_again() -> None:
    watch = Watch(URL, now=Time())
    watch.take(frame())
    watch.lose("the connection was lost")

    watch.take(frame(after(1)))

    assert watch.contact() == Contact(Level.LIVE, 0.0)


def test_a_handshake_alone_is_no_contact() -> None:
    watch = Watch(URL, now=Time())

    watch.take(hello())

    assert watch.contact().level is Level.CONNECTING


def test_before_the_first_contact_it_is_connecting_and_after_a_while_there_is_none() -> None:
    time = Time()
    watch = Watch(URL, now=time)
    watch.lose("no service answers")

    assert watch.contact() == Contact(Level.CONNECTING, 0.0, "no service answers")
    time.now_s += 4.0
    assert watch.contact() == Contact(Level.LOST, 4.0, "no service answers")


def test_the_time_of_a_view_is_that_of_the_service() -> None:
    time = Time()
    watch = Watch(URL, now=time)
    watch.take(frame())

    time.now_s += 2.0

    assert watch.view().age_s(AT) == 2.0


def test_news_are_told_with_the_frame_that_what_came_before_fits() -> None:
    told: list[int] = []
    watch = Watch(URL, lambda: told.append(watch.robot.last_event_id), Time())

    watch.take(hello())
    watch.take(event(3))
    watch.take(frame())
    watch.lose("the connection was lost")

    assert told == [3, 3]


def test_local_time_does_not_go_back() -> None:
    assert local_now() <= local_now()


def test_before_the_first_frame_it_is_our_own() -> None:
    assert ServerClock().at(100.0) == 100.0


def test_of_several_frames_the_one_that_travelled_least_counts() -> None:
    clock = ServerClock()

    clock.observe(1000.0, 10.5)
    clock.observe(1001.0, 11.1)
    clock.observe(1002.0, 12.9)

    assert clock.at(13.0) == 1002.9


def test_when_either_clock_is_set_that_is_noticed_within_two_windows() -> None:
    clock = ServerClock()
    clock.observe(1000.0, 10.0)

    for local_s in (25.0, 40.0, 55.0):
        clock.observe(500.0 + local_s, local_s)

    assert clock.at(60.0) == 560.0
