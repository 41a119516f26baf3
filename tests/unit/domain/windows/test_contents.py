"""Which readings a window holds."""

from domain.timebase import seconds
from domain.windows.contents import NEVER, Contents

LENGTH = seconds(5.0)


def _of_a_time(size: int = 10) -> Contents:
    return Contents(LENGTH, size, start=0)


def test_the_oldest_reading_leaves_when_the_window_is_over_it() -> None:
    contents = _of_a_time()
    contents.extend([seconds(1.0), seconds(2.0)], [7.0, 8.0])

    assert contents.next_leaves_at == seconds(6.0)
    assert contents.pop_until(seconds(6.0)) == ([seconds(1.0)], [7.0])
    assert contents.next_leaves_at == seconds(7.0)
    contents.pop_first(1)
    assert contents.next_leaves_at == NEVER


def test_from_a_window_of_a_number_none_leaves_by_time() -> None:
    contents = Contents(None, 2, start=0)
    contents.extend([seconds(1.0)], [7.0])

    assert contents.next_leaves_at == NEVER
    assert contents.leaves_at(0) is None
    assert contents.complete_at() is None
    assert contents.passes_at() is None


def test_a_window_of_a_number_has_passed_when_it_is_full() -> None:
    contents = Contents(None, 2, start=0)
    contents.extend([seconds(1.0)], [7.0])
    assert (contents.has_passed(seconds(99.0)), contents.filled(seconds(99.0))) == (False, 0.5)
    contents.extend([seconds(2.0)], [7.0])
    assert (contents.has_passed(seconds(2.0)), contents.filled(seconds(2.0))) == (True, 1.0)


def test_a_window_of_a_time_has_passed_without_any_reading() -> None:
    contents = _of_a_time()

    assert contents.filled(seconds(2.5)) == 0.5
    assert not contents.has_passed(LENGTH - 1)
    assert contents.has_passed(LENGTH)
    assert contents.filled(seconds(99.0)) == 1.0


def test_a_reading_that_had_to_make_room_is_missing_until_its_time_is_over() -> None:
    contents = _of_a_time(size=2)
    for at_s in (1.0, 2.0):
        contents.extend([seconds(at_s)], [0.0])
    assert contents.is_full
    assert contents.is_complete(seconds(2.0))

    assert contents.make_room() == ([seconds(1.0)], [0.0])
    contents.extend([seconds(3.0)], [0.0])

    assert not contents.is_complete(seconds(6.0) - 1)
    assert contents.is_complete(seconds(6.0))


def test_in_a_window_of_a_number_nothing_is_missing() -> None:
    contents = Contents(None, 1, start=0)
    contents.extend([seconds(1.0)], [7.0])
    contents.make_room()

    assert contents.is_complete(seconds(1.0))


def test_it_remembers_when_something_was_heard_last() -> None:
    contents = _of_a_time()
    assert contents.heard_at == 0
    contents.extend([seconds(1.0)], [7.0])
    contents.pop_first(1)
    assert contents.heard_at == seconds(1.0)


def test_several_readings_leave_together() -> None:
    contents = _of_a_time()
    contents.extend([seconds(1.0), seconds(1.5), seconds(2.0)], [7.0, 8.0, 9.0])

    assert contents.pop_until(seconds(6.5)) == ([seconds(1.0), seconds(1.5)], [7.0, 8.0])
    assert len(contents) == 1


def test_from_a_window_of_a_number_the_surplus_leaves() -> None:
    contents = Contents(None, 2, start=0)
    contents.extend([1, 2, 3], [7.0, 8.0, 9.0])

    assert not contents.is_exceeded_by(10), "none goes before its time"
    assert contents.surplus == 1
    assert contents.pop_until(seconds(99.0)) == ([], [])
    assert contents.pop_first(1) == ([1], [7.0])
