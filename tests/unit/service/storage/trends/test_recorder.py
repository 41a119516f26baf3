"""The thread's work: nothing is lost over restarts, steps of the clock and disks that fail."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import apsw
import pytest

from domain.errors import StorageDegradedError
from domain.health.signals import SignalSettings
from domain.timebase import Duration, Instant, seconds
from service.storage.trends.block_file import BlockFile
from service.storage.trends.history import TrendPoint
from service.storage.trends.known_signals import KnownSignals
from service.storage.trends.recorder import Recorder
from service.storage.trends.rows import Rows
from service.storage.trends.tiers import TIERS
from tests.support.trend_readings import START, load, readings

STORED = Path(__file__).with_name("trends_version_1.db")
MINUTE: Duration = seconds(60.0)


class _Run:
    """One run of the service over a file."""

    def __init__(self, folder: Path, *signals: SignalSettings) -> None:
        self.known = KnownSignals(signals or [load()])
        self.recorder = Recorder(self.known, str(folder / "trends.db"), TIERS)
        self.elapsed: Duration = 0

    def record(self, rows: Rows, for_s: float = 5.0) -> None:
        """Record readings, and let time pass."""
        self.recorder.add({0: rows}, self.elapsed)
        self.elapsed += seconds(for_s)
        self.recorder.settle(self.elapsed)

    def last_minutes(self, end: Instant, minutes: float = 10.0) -> list[TrendPoint]:
        """Return a chart up to `end`."""
        load = self.known.by_name["load"]
        begin = end - seconds(60.0 * minutes)
        return [*self.recorder.trend(load, begin, end, 1_000).points]

    def readings(self) -> int:
        """Return how many readings the coarsest tier knows of."""
        self.recorder.settle(self.elapsed)
        load = self.known.by_name["load"]
        return sum(self.recorder.rows(len(TIERS) - 1, load, 0, 2**62).count)

    def kill(self) -> None:
        """End as by `kill -9`; what was committed is there."""

    def end(self) -> None:
        self.recorder.close(self.elapsed)


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    yield tmp_path
    shutil.rmtree(tmp_path)


def test_what_was_not_yet_written_is_in_the_answer(folder: Path) -> None:
    run = _Run(folder)
    run.recorder.add({0: readings([1.0, 9.0])}, 0)

    assert [point.high for point in run.last_minutes(START + MINUTE)] == [1.0, 9.0]
    run.end()


@pytest.mark.parametrize("way", ["end", "kill"])
def test_after_a_restart_each_tier_still_has_every_reading(way: str, folder: Path) -> None:
    run = _Run(folder)
    for piece in range(150):
        values = [99.0 if piece == 77 else 1.0] * 100
        run.record(readings(values, START + piece * seconds(5.0)))
    getattr(run, way)()

    again = _Run(folder)
    again.record(readings([2.0] * 100, START + 20 * MINUTE))

    load = again.known.by_name["load"]
    for tier in range(len(TIERS)):
        rows = again.recorder.rows(tier, load, 0, 2**62)
        # Single readings are deleted after ten minutes.
        assert sum(rows.count) == (15_100 if tier else 12_100), tier
        assert max(rows.high) == 99.0
    again.end()


def test_readings_of_a_run_whose_clock_was_set_back_stand_beside_the_earlier_ones(
    folder: Path,
) -> None:
    run = _Run(folder)
    for piece in range(30):
        run.record(readings([5.0] * 100, START + piece * seconds(5.0)))
    run.end()

    back = _Run(folder)
    for piece in range(30):
        back.record(readings([7.0] * 100, START - MINUTE + piece * seconds(5.0)))

    assert back.readings() == 6_000
    points = back.last_minutes(START + 5 * MINUTE, 7.0)
    assert {point.low for point in points} == {5.0, 7.0}
    assert any(point.low == 5.0 and point.high == 7.0 for point in points)
    back.end()


def test_a_clock_that_is_set_forward_deletes_nothing(folder: Path) -> None:
    run = _Run(folder)
    for piece in range(13):
        run.record(readings([5.0] * 100, START + piece * seconds(5.0)))
    run.end()

    ten_years = seconds(10 * 366 * 86_400.0)
    later = _Run(folder)
    later.record(readings([7.0] * 100, START + ten_years))

    assert later.readings() == 1_400
    assert later.last_minutes(START + MINUTE)[0].high == 5.0
    later.end()


def test_the_finest_tier_goes_first_when_time_goes_on(folder: Path) -> None:
    run = _Run(folder)
    for minute in range(30):
        run.record(readings([1.0] * 12, START + minute * MINUTE, seconds(5.0)), 60.0)

    load = run.known.by_name["load"]
    spans = []
    for tier in (0, 1):
        rows = run.recorder.rows(tier, load, 0, 2**62)
        spans.append(round((max(rows.last) - min(rows.first)) / MINUTE))

    assert 9 <= spans[0] <= 12
    assert spans[1] == 30
    run.end()


def test_a_signal_with_another_unit_begins_anew_and_the_old_one_goes_on(folder: Path) -> None:
    run = _Run(folder)
    run.record(readings([1_000.0] * 100))
    run.end()

    tons = _Run(folder, load(unit="t"))
    tons.record(readings([1.0] * 100, START + MINUTE))
    assert {point.high for point in tons.last_minutes(START + 2 * MINUTE)} == {1.0}
    tons.end()

    again = _Run(folder)
    assert {point.high for point in again.last_minutes(START + 2 * MINUTE)} == {1_000.0}
    assert again.readings() == 100
    again.end()


def test_an_error_that_is_declared_no_longer_is_still_told(folder: Path) -> None:
    run = _Run(folder)
    ranks = [run.known.by_name["load"].rank_of("LOAD_ODD")] * 3
    run.record(readings([1.0] * 3, errors=ranks))
    run.end()

    again = _Run(folder)

    assert {point.error for point in again.last_minutes(START + MINUTE)} == {"LOAD_ODD"}
    again.end()


# --- storage that fails --------------------------------------------------------------------------


def test_without_a_folder_all_goes_on_in_memory_and_the_file_is_tried_again(folder: Path) -> None:
    missing = folder / "missing"
    run = _Run(missing)
    run.record(readings([9.0] * 100), 1.0)
    assert run.recorder.reason is not None
    assert run.last_minutes(START + MINUTE)[0].high == 9.0

    missing.mkdir()
    run.record(readings([1.0], START + MINUTE))

    assert run.recorder.reason is None
    assert run.recorder.dropped == 0
    assert run.readings() == 101
    run.end()


def test_a_full_disk_costs_the_finest_rows_and_no_spike(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise apsw.FullError("database or disk is full")

    run = _Run(folder)
    with monkeypatch.context() as patched:
        patched.setattr(BlockFile, "write", full)
        for piece in range(30):
            values = [99.0 if piece == 3 else 1.0] * 100
            run.record(readings(values, START + piece * seconds(5.0)))
    assert run.recorder.dropped > 0
    assert run.recorder.reason == "database or disk is full"

    for piece in range(30, 40):
        run.record(readings([1.0] * 100, START + piece * seconds(5.0)))

    assert run.recorder.reason is None
    assert run.readings() == 4_000
    assert max(point.high for point in run.last_minutes(START + 10 * MINUTE, 600.0)) == 99.0
    run.end()


def test_a_file_that_cannot_be_read_is_no_empty_chart(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise apsw.IOError("disk I/O error")

    run = _Run(folder)
    run.record(readings([1.0]))
    monkeypatch.setattr(BlockFile, "read", fails)

    with pytest.raises(StorageDegradedError, match="disk I/O error"):
        run.last_minutes(START + MINUTE)
    run.end()


@pytest.mark.parametrize(
    "content", [b"no database at all" * 100, b"SQLite format 3\0" + b"x" * 5_000]
)
def test_a_broken_file_is_put_aside(content: bytes, folder: Path) -> None:
    (folder / "trends.db").write_bytes(content)

    run = _Run(folder)
    run.record(readings([1.0]))

    assert _broken(folder).read_bytes() == content
    assert run.recorder.reason is None
    assert run.readings() == 1
    run.end()


def test_a_file_of_a_newer_version_is_put_aside(folder: Path) -> None:
    with apsw.Connection(str(folder / "trends.db")) as newer:
        newer.execute("PRAGMA user_version = 2")
    newer.close()

    run = _Run(folder)
    run.record(readings([1.0]))

    with apsw.Connection(str(_broken(folder))) as kept:
        assert [*kept.execute("PRAGMA user_version")] == [(2,)]
    kept.close()
    run.end()


def test_a_file_that_breaks_while_it_is_used_is_put_aside(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def breaks(*_: object) -> None:
        raise apsw.CorruptError("database disk image is malformed")

    run = _Run(folder)
    with monkeypatch.context() as patched:
        patched.setattr(BlockFile, "write", breaks)
        run.record(readings([1.0]))

    run.record(readings([2.0], START + MINUTE))

    assert _broken(folder).exists()
    assert run.recorder.reason is None
    assert run.readings() == 2
    run.end()


def test_a_damaged_block_costs_that_block(folder: Path) -> None:
    run = _Run(folder)
    run.record(readings([1.0] * 100))
    run.record(readings([2.0] * 100, START + seconds(5.0)))
    run.end()
    with apsw.Connection(str(folder / "trends.db")) as file:
        file.execute("UPDATE tier_raw SET data = x'00ff' WHERE id = 1")
    file.close()

    again = _Run(folder)

    assert {point.high for point in again.last_minutes(START + MINUTE)} == {2.0}
    again.end()


def test_a_file_that_the_first_version_wrote_can_be_read(folder: Path) -> None:
    shutil.copy(STORED, folder / "trends.db")

    run = _Run(folder)

    load = run.known.by_name["load"]
    # Ten hours, and a reading each second.
    assert run.readings() == 36_000
    for tier in range(len(TIERS)):
        rows = run.recorder.rows(tier, load, 0, 2**62)
        assert (max(rows.high), load.errors_of([max(rows.error)])) == (1600.0, ["LOAD_OVERLOAD"])
    run.end()


def _broken(folder: Path) -> Path:
    """Return the file that was put aside."""
    (found,) = (path for path in folder.glob("trends.db.broken-*Z"))
    return found
