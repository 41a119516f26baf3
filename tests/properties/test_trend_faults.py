"""Whatever operation of the disk fails: the history goes on, and a restart finds all but the last.

One story, with a restart, is told again for each operation on the disk and each way to fail.
"""

import gc
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from domain.timebase import seconds
from service.storage.trends.known_signals import KnownSignals
from service.storage.trends.recorder import Recorder
from tests.support.faulty_disk import Fault, FaultyDisk, faulty
from tests.support.trend_readings import SMALL_TIERS, START, load, readings

pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")

SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
PIECES, IN_PIECE, EVERY_S = 20, 20, 5.0
COARSEST = len(SMALL_TIERS) - 1


@pytest.fixture(autouse=True)
def _collected() -> Iterator[None]:
    yield
    # Connections to a dead disk complain when they go, which is to be during the test.
    gc.collect()


class _Story:
    """Readings for a minute and a half, with a restart in the middle."""

    def __init__(self, folder: Path) -> None:
        self.path = str(folder / "trends.db")
        self.given = 0
        self._elapsed = 0
        self._start()

    def _start(self) -> None:
        self.known = KnownSignals([load()])
        self.recorder = Recorder(self.known, self.path, SMALL_TIERS)

    def tell(self) -> Iterator[int]:
        """Tell it piece by piece."""
        for piece in range(PIECES):
            at = START + piece * seconds(EVERY_S)
            value = 99.0 if piece == 7 else 1.0
            self.recorder.add({0: readings([value] * IN_PIECE, at)}, self._elapsed)
            self.given += IN_PIECE
            self._elapsed += seconds(EVERY_S)
            self.recorder.settle(self._elapsed)
            if piece == PIECES // 2:
                self.recorder.close(self._elapsed)
                self._elapsed = 0
                self._start()
            yield piece

    def counted(self) -> int:
        self.recorder.settle(self._elapsed)
        rows = self.recorder.rows(COARSEST, self.known.by_name["load"], 0, 2**62)
        return sum(rows.count)


def _operations(folder: Path) -> int:
    folder.mkdir()
    with faulty(FaultyDisk(folder)) as disk:
        story = _Story(folder)
        assert len([*story.tell()]) == PIECES
        story.recorder.close(0)
    return disk.count


@pytest.mark.parametrize("fault", ["fails", "full", "is short", "is slow"])
def test_a_disk_that_fails_once_costs_no_more_than_what_was_being_closed(
    fault: Fault, tmp_path: Path
) -> None:
    operations = _operations(tmp_path / "whole")
    for at in range(1, operations + 1, 1 if SOAK else 9):
        folder = tmp_path / f"at_{at}"
        folder.mkdir()
        with faulty(FaultyDisk(folder, fault, at, slow_s=0.001)):
            story = _Story(folder)
            assert len([*story.tell()]) == PIECES
            assert story.given - story.counted() <= IN_PIECE, at
            story.recorder.close(seconds(EVERY_S))

        again = _Story(folder)
        assert story.given - IN_PIECE <= again.counted() <= story.given, at
        assert again.recorder.reason is None
        again.recorder.close(0)


@pytest.mark.parametrize("lasts", [30, 10_000])
def test_a_disk_that_fails_for_long_is_used_again_once_it_works(lasts: int, tmp_path: Path) -> None:
    for at in range(1, 60, 1 if SOAK else 9):
        folder = tmp_path / f"at_{at}"
        folder.mkdir()
        with faulty(FaultyDisk(folder, "full", at, lasts)) as disk:
            story = _Story(folder)
            assert len([*story.tell()]) == PIECES
            disk.lasts = 0
            counted = story.counted()
            story.recorder.close(seconds(EVERY_S))

        assert counted <= story.given
        again = _Story(folder)
        assert again.counted() == counted, at
        again.recorder.close(0)


@pytest.mark.parametrize("fault", ["dies", "loses power"])
def test_where_the_process_dies_all_but_the_last_readings_are_there(
    fault: Fault, tmp_path: Path
) -> None:
    operations = _operations(tmp_path / "whole")
    for at in range(1, operations + 1, 1 if SOAK else 9):
        folder = tmp_path / f"at_{at}"
        folder.mkdir()
        with faulty(FaultyDisk(folder, fault, at)) as disk:
            story = _Story(folder)
            for _ in story.tell():
                if disk.left is not None:
                    break
            else:
                story.recorder.close(0)
            # It would not have gone on.
            left, given = disk.left, story.given
            # So that its connections can be closed.
            disk.left, disk.fault = None, "none"
            story.recorder.close(0)
        assert left is not None

        again = _Story(left)
        counted = again.counted()
        assert counted <= given
        if fault == "dies":
            assert given - counted <= IN_PIECE, at
        assert again.recorder.reason is None
        again.recorder.close(0)
