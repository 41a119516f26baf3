"""Emergency stops over the link, of this computer and of another one."""

from domain.computers import Incarnation, PeerStop, StopId
from domain.link.messages import EngagedStop
from domain.link.stops import MAX_STOPS, HeardStops, OwnStops
from domain.timebase import seconds

A, B, X = Incarnation("a"), Incarnation("b"), Incarnation("x")


def own(*ids: str, since_s: float = 0) -> tuple[PeerStop, ...]:
    return tuple(PeerStop(StopId(name), "ada", "smoke", seconds(since_s)) for name in ids)


def engaged(*ids: str, age_s: float = 0) -> tuple[EngagedStop, ...]:
    return tuple(EngagedStop(StopId(name), "ada", "smoke", seconds(age_s)) for name in ids)


class Listener:
    """Hears of the stops of a computer whose process A is dealt with."""

    def __init__(self) -> None:
        self.stops = HeardStops()
        self.now_s = 10.0

    def hears(
        self, process: Incarnation, version: int, *ids: str, lives: bool = True, age_s: float = 0
    ) -> None:
        said, now = engaged(*ids, age_s=age_s), seconds(self.now_s)
        self.stops.take(process, version, said, now, lives=lives, is_dealt_with=process == A)


# --- our own -------------------------------------------------------------------------------------


def test_others_are_told_how_long_a_stop_is_engaged() -> None:
    stops = OwnStops()

    assert stops.set(own("s1", since_s=2))
    assert stops.told(seconds(5)) == engaged("s1", age_s=3)


def test_only_a_change_raises_the_version() -> None:
    stops = OwnStops()
    changes = [stops.set(own("s1")), stops.set(own("s1")), stops.set(())]

    assert changes == [True, False, True]
    assert stops.version == 2


def test_a_release_is_taken_once_and_only_of_what_is_engaged() -> None:
    stops = OwnStops()
    stops.set(own("s1", "s2"))

    assert stops.take_release([StopId("s1"), StopId("s9"), StopId("s1")]) == ("s1",)
    assert stops.take_release([StopId("s1")]) == ()

    stops.set(own("s2"))
    stops.set(own("s1", "s2"))
    assert stops.take_release([StopId("s1")]) == ("s1",)


def test_more_stops_than_fit_into_a_beat_are_not_told() -> None:
    stops = OwnStops()
    stops.set(own(*(f"s{number}" for number in range(100))))

    assert len(stops.told(0)) == MAX_STOPS


# --- those of another ----------------------------------------------------------------------------


def test_a_stop_is_news_once_and_counts_from_when_it_was_engaged() -> None:
    listener = Listener()
    listener.hears(A, 1, "s1", age_s=4)

    first = listener.stops.news(is_dealt_with=True, is_all=True)
    listener.hears(A, 2, "s1", age_s=4.2)

    assert first == (own("s1", since_s=6), None, True)
    assert listener.stops.news(is_dealt_with=True, is_all=True) is None


def test_it_is_news_that_a_computer_has_no_stop_once_it_is_dealt_with() -> None:
    stops = HeardStops()

    assert stops.news(is_dealt_with=False, is_all=False) is None
    assert stops.news(is_dealt_with=True, is_all=False) == ((), (), True)


def test_it_is_news_that_all_who_live_told_their_stops() -> None:
    stops = HeardStops()
    stops.news(is_dealt_with=True, is_all=False)

    assert stops.news(is_dealt_with=True, is_all=True) == ((), None, True)
    assert stops.news(is_dealt_with=True, is_all=True) is None


def test_before_that_only_what_was_heard_can_end() -> None:
    listener = Listener()
    listener.hears(X, 1, "x1", "x2")
    first = listener.stops.news(is_dealt_with=False, is_all=False)
    listener.hears(X, 2, "x2")
    then = listener.stops.news(is_dealt_with=False, is_all=False)

    assert first == (own("x1", "x2", since_s=10), (), False)
    assert then == (own("x2", since_s=10), ("x1",), False)


def test_the_process_that_is_dealt_with_ended_what_it_had_before_it_was() -> None:
    listener = Listener()
    listener.hears(B, 1, "s1")
    listener.stops.take(A, 1, engaged("s1"), seconds(11), lives=True, is_dealt_with=False)
    listener.stops.take(A, 2, (), seconds(12), lives=True, is_dealt_with=False)
    both_answer = listener.stops.ids
    listener.stops.take(A, 2, (), seconds(13), lives=True, is_dealt_with=True)

    assert both_answer == {"s1"}
    assert listener.stops.ids == frozenset()


def test_of_what_a_process_ended_a_bounded_number_is_remembered() -> None:
    listener = Listener()
    listener.hears(B, 1, "first", "last")
    for version in range(MAX_STOPS):
        said = engaged("first" if version == 0 else f"s{version}", "last")
        listener.stops.take(A, version, said, seconds(11), lives=True, is_dealt_with=False)
    listener.hears(A, MAX_STOPS)

    assert listener.stops.ids == {"first"}


def test_what_is_older_than_what_was_heard_is_no_news() -> None:
    listener = Listener()
    listener.hears(A, 2)
    listener.hears(A, 1, "s1")

    assert listener.stops.ids == frozenset()
    assert listener.stops.version_of(A) == 2


def test_an_impostor_engages_a_stop_and_releases_none_but_its_own() -> None:
    listener = Listener()
    listener.hears(A, 1, "s1")
    listener.hears(X, 1, "x1")
    listener.hears(X, 2)

    assert listener.stops.ids == {"s1"}
    assert listener.stops.version_of(X) == 2
    assert listener.stops.version_of(None) == 0


def test_a_stop_that_its_process_released_counts_no_more() -> None:
    listener = Listener()
    listener.hears(A, 1, "s1", "s2")
    listener.hears(A, 2, "s2")

    assert listener.stops.ids_of(A) == {"s2"}
    assert listener.stops.ids_of(B) == frozenset()


def test_a_stop_of_a_replaced_process_that_arrives_late_is_no_new_one() -> None:
    listener = Listener()
    listener.hears(B, 1, "s1")
    listener.stops.replace(B)
    listener.hears(B, 2, "s1", "s2", lives=False)

    assert listener.stops.ids == {"s2"}, "a stop that nobody knew of counts"
    assert listener.stops.version_of(B) == 0, "it was not taken in as a whole"


def test_a_stop_that_the_store_kept_stands_also_while_its_computer_hears_nobody() -> None:
    listener = Listener()
    listener.hears(B, 1, "s1")
    listener.hears(A, 1, "s1")
    listener.stops.replace(B)
    listener.hears(A, 2, "s1", "s2", lives=False)

    assert listener.stops.ids == {"s1", "s2"}


def test_a_replaced_process_that_lives_still_stops_the_robot() -> None:
    listener = Listener()
    listener.hears(B, 1, "s1")
    listener.stops.replace(B)
    listener.stops.replace(X)
    listener.hears(B, 1, "s1", lives=True)

    assert listener.stops.ids == {"s1"}


def test_a_stop_of_a_process_that_nobody_can_ask_is_ended_by_name() -> None:
    listener = Listener()
    listener.hears(X, 1, "x1", "x2")
    listener.stops.end(X, [StopId("x1"), StopId("s9")])
    left = listener.stops.ids
    listener.stops.end(X, [StopId("x2")])
    listener.stops.end(B, [StopId("x2")])

    assert left == {"x2"}
    assert listener.stops.processes() == ()


def test_many_impostors_are_bounded_and_keep_no_room_from_the_computer_itself() -> None:
    listener = Listener()
    for number in range(100):
        listener.hears(Incarnation(f"x{number}"), 1, *(f"x{number}-{each}" for each in range(100)))
    listener.hears(A, 1, "s1")

    assert len(listener.stops.processes()) == 9
    assert "s1" in listener.stops.ids
    news = listener.stops.news(is_dealt_with=True, is_all=True)
    assert news is not None
    assert len(news[0]) == MAX_STOPS


def test_an_impostor_without_a_stop_is_not_remembered() -> None:
    listener = Listener()
    listener.hears(X, 1)

    assert listener.stops.processes() == ()


def test_a_computer_that_starts_again_and_again_with_a_stop_leaves_a_bounded_number() -> None:
    heard = HeardStops()
    for number in range(30):
        process = Incarnation(f"p{number}")
        stop = engaged(f"s{number}")
        heard.take(process, 1, stop, number, lives=True, is_dealt_with=True)

    assert heard.ids == {f"s{number}" for number in range(21, 30)}
