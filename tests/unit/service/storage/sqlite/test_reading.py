from datetime import UTC, datetime
from pathlib import Path

import pytest

from service.storage.journal import EventQuery
from service.storage.sqlite.log_file import LogFile, Next
from service.storage.sqlite.log_summary import LogSummary
from service.storage.sqlite.reading import read_events
from tests.support.log_files import NO_CHANGES, batch, flight, log_file, run


def file_of(folder: Path, number: int, *events: int) -> LogFile:
    file = log_file(folder / f"{number:06}.db", Next(number, number, events[0]), number)
    file.write(flight(batch(number, number, b"step", events=events)), run(), NO_CHANGES)
    return file


@pytest.fixture
def files(tmp_path: Path) -> list[LogSummary]:
    made = [file_of(tmp_path, 1, 1, 2), file_of(tmp_path, 2, 3, 4), file_of(tmp_path, 3, 5, 6)]
    for file in made:
        file.finish()
    return [file.summary for file in made]


def ids(
    files: list[LogSummary], after: int | None = None, before: int | None = None, limit: int = 100
) -> list[int]:
    query = EventQuery(after, before, limit=limit)
    return [event.id for event in read_events(files, query)]


def test_events_are_read_over_all_files_in_order(files: list[LogSummary]) -> None:
    assert ids(files) == ids(files, after=0) == [1, 2, 3, 4, 5, 6]
    assert ids(files, limit=3) == [4, 5, 6]
    assert ids(files, after=1, limit=3) == [2, 3, 4]
    assert ids(files, before=5, limit=3) == [2, 3, 4]
    assert ids(files, limit=0) == []


def test_files_that_cannot_have_any_are_not_opened(files: list[LogSummary]) -> None:
    files[0].path.write_bytes(b"not to be read")

    assert ids(files, after=2) == [3, 4, 5, 6]
    assert ids(files, limit=4) == [3, 4, 5, 6]


def test_a_file_that_was_dropped_meanwhile_is_left_out(files: list[LogSummary]) -> None:
    files[0].path.unlink()

    assert ids(files) == [3, 4, 5, 6]


def test_the_newest_file_may_have_more_than_was_reported(tmp_path: Path) -> None:
    file = log_file(tmp_path / "000001.db")
    reported = file.summary
    file.write(flight(batch(1, 1, b"step", events=(1, 2))), run(), NO_CHANGES)

    assert ids([reported]) == [1, 2]
    file.finish()


def test_all_times_of_a_calendar_may_be_asked_for(files: list[LogSummary]) -> None:
    first, last = datetime.min.replace(tzinfo=UTC), datetime.max.replace(tzinfo=UTC)

    assert len(read_events(files, EventQuery(from_at=first, to_at=last))) == 6
    assert read_events(files, EventQuery(from_at=last)) == []
    assert read_events(files, EventQuery(to_at=first)) == []


def test_there_may_be_no_files() -> None:
    assert ids([]) == []
