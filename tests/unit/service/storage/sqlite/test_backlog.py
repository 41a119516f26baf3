from domain.events.driving import HoldSet
from domain.events.event import RecordedEvent
from service.storage.event_rows import event_row
from service.storage.sqlite.backlog import Backlog, joined
from service.storage.sqlite.batch import Hole
from tests.support.noted_robot import ADA

KEY = ("kept_hold", "operator")
ROW = event_row(RecordedEvent(1, 0, None, ADA, HoldSet("operator", "")), 0)


def backlog(limit: int = 1_000) -> Backlog:
    return Backlog(limit, next_batch=5, next_step=11)


def test_a_flight_has_all_that_was_noted_since_the_last_one() -> None:
    waiting = backlog()
    waiting.add_step(b"one", 100, 7)
    waiting.add_step(b"two", 200, 8, [ROW])
    waiting.change(KEY, b"value")

    (batch,) = waiting.take(must_last=True).batches

    assert (batch.number, batch.first_step, batch.steps) == (5, 11, [b"one", b"two"])
    assert (batch.first_at, batch.last_at, batch.wall_ns) == (100, 200, 8)
    assert (batch.events, batch.changes) == ([ROW], {KEY: b"value"})
    assert waiting.is_empty
    waiting.written()
    assert waiting.size == 0


def test_a_flight_of_nothing_still_is_a_batch() -> None:
    waiting = backlog()

    assert waiting.is_empty
    (batch,) = waiting.take(must_last=True).batches
    assert (batch.number, batch.first_step, batch.steps) == (5, 11, [])


def test_what_was_not_written_flies_again_as_it_was_with_what_came_since() -> None:
    waiting = backlog()
    waiting.add_step(b"one", 100, 0)
    first = waiting.take(must_last=True)
    waiting.add_step(b"two", 200, 0)

    second = waiting.take(must_last=False)

    assert [batch.number for batch in second.batches] == [5, 6]
    assert second.batches[0] is first.batches[0]
    assert second.batches[1].first_step == 12


def test_values_that_come_for_hours_need_no_more_room() -> None:
    waiting = backlog()
    waiting.add_step(b"one", 100, 0)
    waiting.take(must_last=True)
    for hour in range(100):
        waiting.change(KEY, b"%d" % hour)
        flight = waiting.take(must_last=False)

    (batch,) = flight.batches
    assert batch.changes == {KEY: b"99"}


def test_steps_that_do_not_fit_are_counted_where_they_are_missing() -> None:
    waiting = backlog(limit=10)
    waiting.add_step(b"12345", 100, 0)
    waiting.add_step(b"1234567", 200, 0, [ROW])
    waiting.add_step(b"1234567", 300, 0)

    (batch,) = waiting.take(must_last=False).batches

    assert batch.hole == Hole(11, 2, 1, 200, 300, "the queue is full")
    assert (waiting.lost_steps, waiting.lost_events) == (2, 1)


def test_after_a_hole_steps_go_on_in_a_batch_of_their_own() -> None:
    waiting = backlog(limit=10)
    waiting.add_step(b"12345", 100, 0)
    waiting.add_step(b"1234567", 200, 0)
    waiting.add_step(b"123", 300, 0)

    before, after = waiting.take(must_last=False).batches

    assert (before.steps, after.steps) == ([b"12345"], [b"123"])
    assert (before.number, after.number) == (5, 6)
    assert (before.first_step, after.first_step) == (11, 13)
    assert (before.hole is None, after.hole is None) == (False, True)


def test_there_is_room_again_once_something_is_written() -> None:
    waiting = backlog(limit=10)
    waiting.add_step(b"1234567", 100, 0)
    waiting.take(must_last=False)
    waiting.add_step(b"1234567", 200, 0)
    assert waiting.lost_steps == 1

    waiting.written()
    waiting.add_step(b"1234567", 300, 0)

    assert waiting.lost_steps == 1
    hole, following = waiting.take(must_last=False).batches
    assert (hole.first_step, hole.steps, hole.hole is None) == (12, [], False)
    assert following.first_step == 13


def test_a_hole_grows_while_storage_fails() -> None:
    waiting = backlog(limit=10)
    waiting.add_step(b"1234567", 100, 0)
    for second in range(5):
        waiting.take(must_last=False)
        waiting.add_step(b"1234567", 200 + second, 0)

    (batch,) = waiting.take(must_last=False).batches

    assert batch.hole == Hole(11, 5, 0, 200, 204, "the queue is full")


def test_a_state_that_does_not_fit_is_asked_for_again() -> None:
    waiting = backlog(limit=10)

    assert waiting.add_checkpoint(10, 100, b"state")
    assert not waiting.add_checkpoint(10, 200, b"larger state")

    (batch,) = waiting.take(must_last=False).batches
    assert [(taken.step, taken.at, taken.state) for taken in batch.checkpoints] == [
        (10, 100, b"state")
    ]


def test_what_is_wrong_with_its_steps_leaves_a_hole_and_its_values() -> None:
    waiting = backlog()
    waiting.add_step(b"one", 100, 0, [ROW])
    waiting.add_step(b"two", 200, 0)
    waiting.change(KEY, b"value")
    waiting.take(must_last=True)
    waiting.add_step(b"three", 300, 0)

    waiting.discard("it cannot be written")
    gap, following = waiting.take(must_last=False).batches

    assert (gap.first_step, gap.steps, gap.changes) == (11, [], {KEY: b"value"})
    assert gap.hole == Hole(10, 2, 1, 100, 200, "it cannot be written")
    assert (following.number, following.first_step) == (7, 13)
    assert (waiting.lost_steps, waiting.lost_events) == (2, 1)


def test_nothing_is_discarded_that_was_written() -> None:
    waiting = backlog()
    waiting.add_step(b"one", 100, 0)
    waiting.take(must_last=True)
    waiting.written()

    waiting.discard("something else failed")

    assert waiting.is_empty
    assert waiting.lost_steps == 0


def test_two_holes_in_a_row_are_one() -> None:
    first = Hole(10, 2, 1, 100, 200, "first")

    assert joined(None, None) is None
    assert joined(first, None) == joined(None, first) == first
    assert joined(first, Hole(12, 3, 4, 300, 400, "second")) == Hole(10, 5, 5, 100, 400, "first")
