"""What the thread of the history does: packs rows, writes blocks, and reads them back.

Storage that fails stops nothing: blocks are tried again, then dropped and counted. The coarser
tiers still get what they hold, in memory.
"""

import json
import logging
import zlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress

import apsw

from domain.errors import StorageDegradedError
from domain.timebase import Duration, Instant
from service.storage.trends.block_file import (
    Block,
    BlockFile,
    ForeignVersionError,
    set_aside,
)
from service.storage.trends.cascade import Cascade
from service.storage.trends.history import Trend, trend_of
from service.storage.trends.known_signals import KnownSignal, KnownSignals
from service.storage.trends.packing import pack, unpack
from service.storage.trends.rows import NO_ERROR, Rows, RowsBySignal
from service.storage.trends.tiers import Tier, pick_tier

log = logging.getLogger(__name__)

_UNUSABLE = (apsw.NotADBError, apsw.CorruptError, ForeignVersionError)
_UNREADABLE = (KeyError, ValueError, zlib.error)


class Recorder:
    """Keeps the rows of all signals; every method is called in the same thread."""

    def __init__(self, signals: KnownSignals, path: str, tiers: Sequence[Tier]) -> None:
        """Prepare; the file is opened when it is needed first.

        Args:
            signals: All signals.
            path: Of the file, or `MEMORY`.
            tiers: From fine to coarse.
        """
        self.reason: str | None = None
        """Why the file cannot be used; None: it can."""
        self.size = 0
        """Bytes of the blocks in the file, about."""
        self._signals = signals
        self._path = path
        self._tiers = tiers
        self._cascade = Cascade(tiers)
        self._file: BlockFile | None = None
        self._before: Duration = 0
        """Running time of all earlier runs."""
        self._in_file: dict[int, int] = {}
        """Numbers of the signals in the file by those in memory."""

    @property
    def dropped(self) -> int:
        """Return how many rows could not be written."""
        return self._cascade.dropped

    def add(self, rows: RowsBySignal, elapsed: Duration) -> None:
        """Add readings, and write nothing yet.

        Args:
            rows: Readings by signal, in the order of arrival.
            elapsed: Running time of this run.
        """
        self._open()
        self._cascade.add(rows, self._before + elapsed)

    def settle(self, elapsed: Duration) -> None:
        """Write what has waited long enough.

        Args:
            elapsed: Running time of this run.
        """
        self._open()
        ran = self._before + elapsed
        self._cascade.settle(lambda tier, packed: self._write(tier, packed, ran), ran)

    def trend(self, signal: KnownSignal, from_at: Instant, to_at: Instant, points: int) -> Trend:
        """Return the history of a signal.

        Raises:
            StorageDegradedError: The file cannot be read.
        """
        self._open()
        try:
            oldest = [self._oldest(tier, signal) for tier in range(len(self._tiers))]
            tier = pick_tier(self._tiers, oldest, from_at, to_at, points)
            rows = self.rows(tier, signal, from_at, to_at)
        except apsw.Error as error:
            self._fail(error)
            raise StorageDegradedError(f"the history cannot be read: {error}") from error
        return trend_of(rows, signal, self._tiers[tier], from_at, to_at, points)

    def rows(self, tier: int, signal: KnownSignal, from_at: Instant, to_at: Instant) -> Rows:
        """Return the rows of a tier and a signal, in the order of arrival.

        Args:
            tier: Index of the tier.
            signal: The signal.
            from_at: Rows that end before may be left out.
            to_at: Rows that begin after it may be left out.

        Raises:
            apsw.Error: The file cannot be read.
        """
        waiting = self._cascade.rows_of(tier, signal.number)
        if self._file is None:
            return Rows.joined(waiting)
        stored = self._file.read(tier, self._in_file[signal.number], from_at, to_at)
        return Rows.joined([*(rows for _, rows in self._unpacked(tier, stored)), *waiting])

    def close(self, elapsed: Duration) -> None:
        """Write all readings, and close the file."""
        ran = self._before + elapsed
        self._cascade.finish(lambda tier, rows: self._write(tier, rows, ran))
        if self._file is not None:
            self._file.close()

    # --- the file --------------------------------------------------------------------------------

    def _open(self) -> None:
        if self._file is not None:
            return
        try:
            self._file = self._opened()
        except (*_UNUSABLE, apsw.Error, OSError) as error:
            self._fail(error)
        else:
            self.reason = None

    def _opened(self) -> BlockFile:
        """Return the file, once what is in it was taken back; one that is broken is put aside."""
        try:
            return self._taken_back()
        except _UNUSABLE as error:
            self._put_aside(error)
            return self._taken_back()

    def _taken_back(self) -> BlockFile:
        """Return the file, and derive the rows that were not yet packed from the finer tiers."""
        file = BlockFile(self._path, self._tiers)
        try:
            numbers = file.numbers(self._signals.identities)
            self._signals.add(numbers)
            identities = self._signals.identities
            self._in_file = {number: numbers[name] for number, name in enumerate(identities)}
            self._before, self.size = file.ran(), file.size
            waiting = [
                [
                    (number, rows.in_buckets(next_.width))
                    for number, rows in self._unpacked(tier, file.not_in_next(tier))
                ]
                for tier, next_ in enumerate(self._tiers[1:])
            ]
        except BaseException:
            file.close()
            raise
        for tier, blocks in enumerate(waiting, 1):
            for number, rows in blocks:
                self._cascade.add({number: rows}, self._before, tier)
        return file

    def _put_aside(self, error: Exception) -> None:
        aside = set_aside(self._path)
        log.warning("the history of signals begins anew; %s is kept: %s", aside, error)

    def _fail(self, error: Exception) -> None:
        """Note why the file cannot be used; one that turns out to be broken is put aside."""
        if self.reason is None:
            log.warning("the history of signals cannot be stored: %s", error)
        self.reason = str(error)
        if self._file is not None and isinstance(error, _UNUSABLE):
            self._file.close()
            self._file = None
            with suppress(OSError):
                self._put_aside(error)

    # --- blocks ----------------------------------------------------------------------------------

    def _write(self, tier: int, rows: RowsBySignal, ran: Duration) -> bool:
        if self._file is None:
            return False
        try:
            self._file.write(tier, [*self._packed(tier, rows)], ran)
        except apsw.Error as error:
            self._fail(error)
            return False
        self.reason, self.size = None, self._file.size
        return True

    def _packed(self, index: int, rows: RowsBySignal) -> Iterator[Block]:
        tier = self._tiers[index]
        for number, own in rows.items():
            ranks = _ranks(own)
            errors = self._signals[number].errors_of(ranks)
            yield Block(
                self._in_file[number],
                min(own.first) // tier.unit * tier.unit,
                max(own.last),
                len(own),
                json.dumps(errors) if errors else "",
                pack(own, ranks, tier.unit, is_raw=not tier.width),
            )

    def _unpacked(self, index: int, blocks: Iterable[Block]) -> Iterator[tuple[int, Rows]]:
        """Yield the rows of blocks, each with the number of its signal."""
        tier = self._tiers[index]
        in_memory = {stored: number for number, stored in self._in_file.items()}
        for block in blocks:
            try:
                number = in_memory[block.signal]
                errors = json.loads(block.errors) if block.errors else []
                ranks = [*map(self._signals[number].rank_of, errors)]
                rows = unpack(
                    block.data, block.rows, block.from_at, ranks, tier.unit, is_raw=not tier.width
                )
            except _UNREADABLE as error:
                log.warning("a block of %s cannot be read: %s", tier.name, error)
            else:
                yield number, rows

    def _oldest(self, tier: int, signal: KnownSignal) -> Instant | None:
        waiting = self._cascade.oldest(tier, signal.number)
        stored = None
        if self._file is not None:
            stored = self._file.oldest(tier, self._in_file[signal.number])
        return min((at for at in (waiting, stored) if at is not None), default=None)


def _ranks(rows: Rows) -> list[int]:
    """Return the ranks of the errors in rows; at most 255, the worst ones."""
    return sorted({*rows.error} - {NO_ERROR})[-255:]
