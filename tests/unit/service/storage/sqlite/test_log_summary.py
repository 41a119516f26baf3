from pathlib import Path

import pytest

from service.storage.sqlite.connection import open_to_write, reading
from service.storage.sqlite.log_file import Next
from service.storage.sqlite.log_summary import LogSummary, summary_of
from tests.support.log_files import NO_CHANGES, batch, flight, log_file, row, run


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "000001.db"


def summary(path: Path) -> LogSummary:
    with reading(path) as connection:
        return summary_of(connection, path, 1)


def test_of_a_file_without_steps_it_is_known_where_they_go_on(path: Path) -> None:
    log_file(path, Next(step=11, batch=5)).finish()

    assert summary(path) == LogSummary(path, 1, 4, next_step=11, epochs={"epoch-1": 0})


def test_what_is_read_is_what_was_counted_while_it_was_written(path: Path) -> None:
    file = log_file(path)
    file.write(flight(batch(1, 1, b"one", b"two", at=100, events=(1, 2))), run(), NO_CHANGES)
    file.write(flight(batch(2, 3, b"three", at=500, events=(3,))), run(), NO_CHANGES)
    counted = file.summary
    file.finish()

    found = summary(path)

    assert (found.first_event, found.last_event) == (1, 3)
    assert (found.first_event_wall_ns, found.last_event_wall_ns) == (1_000, 3_000)
    assert (found.next_step, found.running_ns, found.last_at) == (4, 400, 500)
    assert found.epochs == {"epoch-1": 3}
    assert {**vars_of(found), "epochs": None} == {**vars_of(counted), "epochs": None}


def vars_of(found: LogSummary) -> dict[str, object]:
    return {name: getattr(found, name) for name in LogSummary.__slots__}


def test_each_run_has_the_last_of_its_own_events(path: Path) -> None:
    file = log_file(path)
    file.write(flight(batch(1, 1, b"one", events=(1, 2))), run(), NO_CHANGES)
    file.begin_run(run(2), {}, Next(2, 2, event=10_001))
    file.begin_run(run(3), {}, Next(2, 2, event=20_001))
    file.write(flight(batch(2, 2, b"two", events=(20_001,))), run(3), NO_CHANGES)
    file.finish()

    assert summary(path).epochs == {"epoch-1": 2, "epoch-2": 0, "epoch-3": 20_001}


def test_events_are_added_to_a_summary(path: Path) -> None:
    nothing = LogSummary(path, 1)

    assert nothing.with_events([]) is nothing
    some = nothing.with_events([row(5), row(6)]).with_events([row(7)])
    assert (some.first_event, some.last_event, some.last_event_wall_ns) == (5, 7, 7_000)


def test_a_file_that_lacks_its_beginning_has_no_summary(path: Path) -> None:
    log_file(path).finish()
    connection = open_to_write(path)
    connection.execute("DELETE FROM meta")
    connection.close()

    with pytest.raises(KeyError):
        summary(path)
