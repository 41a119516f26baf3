import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.events.event import RecordedEvent
from service.event_log import EventLog, EventReader, Gap
from tests.support.frames import event


def log_of(count: int, capacity: int = 100) -> EventLog:
    log = EventLog(capacity, epoch="E1")
    for number in range(1, count + 1):
        log.append(event(number))
    return log


def ids(found: list[RecordedEvent | Gap]) -> list[int]:
    return [item.id for item in found if isinstance(item, RecordedEvent)]


def test_an_empty_log_says_so() -> None:
    log = EventLog()

    assert (log.oldest, log.newest) == (1, 0)
    assert list(log.oldest_first()) == []
    assert list(log.newest_first()) == []


def test_two_runs_of_the_service_have_different_epochs() -> None:
    assert EventLog().epoch != EventLog().epoch


def test_events_are_read_in_order_behind_a_cursor() -> None:
    reader = EventReader(log_of(5), after=2, epoch="E1")

    assert ids(reader.take(10)) == [3, 4, 5]


def test_events_are_read_in_portions_without_loss() -> None:
    reader = EventReader(log_of(5), after=0)

    assert [ids(reader.take(2)) for _ in range(4)] == [[1, 2], [3, 4], [5], []]


def test_a_reader_without_a_cursor_gets_only_what_is_new() -> None:
    log = log_of(5)
    reader = EventReader(log)
    assert reader.take(10) == []

    log.append(event(6))

    assert ids(reader.take(10)) == [6]


def test_the_oldest_events_are_forgotten() -> None:
    log = log_of(25, capacity=10)

    assert (log.oldest, log.newest) == (16, 25)
    assert [item.id for item in log.oldest_first()] == list(range(16, 26))
    assert [item.id for item in log.newest_first()] == list(range(25, 15, -1))


def test_a_reader_that_comes_too_late_is_told_what_is_missing() -> None:
    reader = EventReader(log_of(25, capacity=10), after=3, epoch="E1")

    found = reader.take(2)

    assert found[0] == Gap(4, 15, "E1")
    assert ids(found) == [16, 17]
    assert ids(reader.take(100)) == list(range(18, 26))


def test_a_reader_that_falls_behind_while_reading_is_told_too() -> None:
    log = log_of(10, capacity=10)
    reader = EventReader(log, after=0)
    reader.take(2)
    for number in range(11, 16):
        log.append(event(number))

    found = reader.take(100)

    assert found[0] == Gap(3, 5, "E1")
    assert ids(found) == list(range(6, 16))


def test_a_reader_just_in_time_misses_nothing() -> None:
    found = EventReader(log_of(25, capacity=10), after=15).take(100)

    assert not any(isinstance(item, Gap) for item in found)
    assert ids(found) == list(range(16, 26))


def test_after_a_restart_everything_is_new_and_a_gap_is_told() -> None:
    reader = EventReader(log_of(3), after=88, epoch="E0")

    found = reader.take(10)

    assert found[0] == Gap(89, None, "E0")
    assert ids(found) == [1, 2, 3]


def test_after_a_restart_with_many_events_both_gaps_are_told() -> None:
    found = EventReader(log_of(25, capacity=10), after=88, epoch="E0").take(1)

    assert found[:2] == [Gap(89, None, "E0"), Gap(1, 15, "E1")]
    assert ids(found) == [16]


def test_a_cursor_ahead_of_the_log_must_be_of_another_run() -> None:
    found = EventReader(log_of(3), after=4).take(10)

    assert found[0] == Gap(5, None, "E1")
    assert ids(found) == [1, 2, 3]


def test_an_event_out_of_order_is_a_fault_of_the_program() -> None:
    with pytest.raises(ValueError, match="event 7 does not follow event 5"):
        log_of(5).append(event(7))


def test_a_reader_is_woken_by_each_event() -> None:
    log, wakes = EventLog(), list[None]()

    with log.watch(lambda: wakes.append(None)):
        log.append(event(1))

    assert len(wakes) == 1


def test_ids_go_on_after_those_of_earlier_runs() -> None:
    log = EventLog(10, "E3", before=50, earlier={"E1": 20, "E2": 45})
    log.append(event(51))

    assert (log.oldest, log.newest) == (51, 51)
    assert [log.epoch_of(number) for number in (1, 20, 21, 45, 46, 51)] == [
        *("E1", "E1", "E2", "E2", "E3", "E3")
    ]


@pytest.mark.parametrize(
    ("after", "epoch", "is_foreign"),
    [
        (20, "E1", False),
        (50, "E2", False),
        (51, "E2", True),
        (20, "E0", True),
        (51, "E3", False),
        (20, "E3", False),
        (52, "E3", True),
        (20, None, False),
        (52, None, True),
    ],
)
def test_a_cursor_of_a_run_that_is_kept_leads_on(
    after: int, epoch: str | None, *, is_foreign: bool
) -> None:
    log = EventLog(10, "E3", before=50, earlier={"E1": 20, "E2": 45})
    log.append(event(51))

    assert log.is_foreign(after, epoch) is is_foreign


def test_a_reader_from_an_unknown_run_begins_with_this_run() -> None:
    log = EventLog(10, "E3", before=50, earlier={"E1": 20})
    log.append(event(51))

    assert EventReader(log, 7, "E0").take(10) == [Gap(8, None, "E0"), event(51)]


def test_events_between_two_ids_are_those_that_are_kept() -> None:
    log = log_of(25, capacity=10)

    assert ids([*log.between(0)]) == list(range(16, 26))
    assert ids([*log.between(17, 20)]) == [18, 19]
    assert log.between(25) == log.between(30, 10) == log.between(0, 16) == []


@given(
    capacity=st.integers(1, 8),
    after=st.integers(0, 30),
    portions=st.lists(st.tuples(st.integers(0, 12), st.integers(1, 5)), max_size=12),
)
def test_whatever_the_pace_each_event_is_read_once_or_told_as_missing(
    capacity: int, after: int, portions: list[tuple[int, int]]
) -> None:
    log = log_of(30, capacity)
    reader, known = EventReader(log, after), list[int]()
    for appended, limit in [*portions, (0, 1000)]:
        for _ in range(appended):
            log.append(event(log.newest + 1))
        for item in reader.take(limit):
            if isinstance(item, Gap):
                assert item.last is not None
                known.extend(range(item.first, item.last + 1))
            else:
                known.append(item.id)

    assert known == list(range(after + 1, log.newest + 1))
