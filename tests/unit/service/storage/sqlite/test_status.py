from datetime import UTC, datetime
from pathlib import Path

from service.storage.journal import LogStatus
from service.storage.sqlite.folder import Report
from service.storage.sqlite.log_summary import LogSummary
from service.storage.sqlite.status import status_of

SECOND = 10**9
FIRST = LogSummary(Path("1"), 1, first_wall_ns=1 * SECOND, wall_ns=5 * SECOND, step_bytes=10)
SECOND_FILE = LogSummary(
    Path("2"),
    2,
    first_wall_ns=6 * SECOND,
    wall_ns=9 * SECOND,
    step_bytes=20,
    event_bytes=7,
    first_event=1,
    last_event=2,
    first_event_wall_ns=7 * SECOND,
    last_event_wall_ns=8 * SECOND,
)


def at(second: int) -> datetime:
    return datetime.fromtimestamp(second, UTC)


def test_the_extent_of_a_log_is_that_of_all_its_files() -> None:
    report = Report((FIRST, SECOND_FILE), 300, 10**9, None, False)

    status = status_of(Path("/data"), 4, report, "no disk", (1, 2))

    assert status.logs["inputs"] == LogStatus(at(1), at(9), 30)
    assert status.logs["events"] == LogStatus(at(7), at(8), 7)
    assert (status.path, status.bytes, status.free_bytes, status.boot) == ("/data", 300, 10**9, 4)
    assert (status.reason, status.lost_inputs, status.lost_events) == ("no disk", 1, 2)


def test_an_empty_log_has_no_extent() -> None:
    report = Report((LogSummary(Path("1"), 1),), 0, None, None, False)

    status = status_of(Path("/data"), 1, report, None, (0, 0))

    assert status.logs["inputs"] == status.logs["events"] == LogStatus(None, None, 0)
