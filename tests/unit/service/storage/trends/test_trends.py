"""The history of signals as the service uses it."""

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path
from threading import Event

import pytest

from domain.errors import StorageDegradedError, UnknownSignalError
from domain.health.signals import default_signals
from domain.timebase import seconds
from service.storage.trends import trends as module
from service.storage.trends.block_file import MEMORY
from service.storage.trends.recorder import Recorder
from service.storage.trends.trends import HAND_OVER, Trends
from tests.support.trend_readings import START, load
from tests.support.waiting import until

MINUTE = seconds(60.0)


@pytest.fixture
async def trends() -> AsyncIterator[Trends]:
    made = Trends([*default_signals(), load()])
    yield made
    await made.close()


async def test_what_was_noted_is_in_the_next_answer(trends: Trends) -> None:
    trends.note("load", START, 1_600.0, "LOAD_OVERLOAD")
    trends.note("estop", START, True, "ESTOP")
    trends.note("signal_strength", START, "LOW_SIGNAL", None)

    answers = [
        (await trends.history(name, START - MINUTE, START, 100)).points
        for name in ("load", "estop", "signal_strength", "temperature")
    ]

    found = [[(point.last, point.error) for point in points] for points in answers]
    assert found == [[(1_600.0, "LOAD_OVERLOAD")], [(1.0, "ESTOP")], [("LOW_SIGNAL", None)], []]


async def test_a_signal_that_there_is_not_has_no_history(trends: Trends) -> None:
    with pytest.raises(UnknownSignalError) as raised:
        await trends.history("laod", START - MINUTE, START, 100)

    assert "did you mean load?" in str(raised.value.hint)


async def test_a_reading_of_a_signal_that_there_is_not_is_left_out(trends: Trends) -> None:
    trends.note("laod", START, 1.0, None)

    assert (await trends.history("load", START - MINUTE, START, 100)).points == []


async def test_once_it_is_closed_nothing_waits_for_it(trends: Trends) -> None:
    await trends.close()
    trends.note("load", START, 1.0, None)
    trends.pass_time(START)
    trends.pass_time(START + HAND_OVER)

    with pytest.raises(StorageDegradedError):
        await trends.history("load", START - MINUTE, START, 100)


async def test_times_that_no_clock_shows_are_answered_too(trends: Trends) -> None:
    trends.note("load", START, 1.0, None)

    trend = await trends.history("load", -(10**30), 10**30, 100)

    assert len(trend.points) == 1


async def test_readings_are_written_every_few_seconds(tmp_path: Path) -> None:
    path = str(tmp_path / "trends.db")
    trends = Trends([load()], path)
    for second in range(12):
        trends.note("load", START + seconds(second), float(second), None)
        trends.pass_time(START + seconds(second))

    # As after `kill -9`: another run sees what was written.
    await until(lambda: trends.status.bytes > 0)
    other = Trends([load()], path)
    points = (await other.history("load", START, START + MINUTE, 100)).points

    assert [point.last for point in points][:6] == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    await other.close()
    await trends.close()


async def test_at_the_end_everything_is_written(tmp_path: Path) -> None:
    path = str(tmp_path / "trends.db")
    trends = Trends([load()], path)
    trends.pass_time(START)
    trends.note("load", START, 7.0, None)
    await trends.close()

    again = Trends([load()], path)
    points = (await again.history("load", START - MINUTE, START, 100)).points

    assert [point.last for point in points] == [7.0]
    await again.close()


async def test_a_disk_that_hangs_stops_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    released = Event()
    monkeypatch.setattr(Recorder, "settle", lambda *_: released.wait(30))
    monkeypatch.setattr(module, "_MOST_CHARTS", 1)
    trends = Trends([load()], str(tmp_path / "trends.db"))
    trends.pass_time(START)
    trends.pass_time(START + HAND_OVER)

    asked = asyncio.create_task(trends.history("load", START - MINUTE, START, 100))
    await asyncio.sleep(0)
    with pytest.raises(StorageDegradedError, match="too long"):
        await trends.history("load", START - MINUTE, START, 100)
    trends.note("load", START, 1.0, None)
    trends.pass_time(START + 2 * HAND_OVER)

    released.set()
    assert (await asked).points == []
    await trends.close()


async def test_a_mistake_in_the_thread_is_logged(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fails(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(Recorder, "settle", fails)
    trends = Trends([load()], MEMORY)
    trends.pass_time(START)
    trends.pass_time(START + HAND_OVER)
    await trends.close()

    assert "readings are missing in the history of signals" in caplog.text
