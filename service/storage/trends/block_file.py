"""The file `trends.db`: blocks of rows by tier and signal, deleted whole and oldest first.

It is read and written by one thread. Commits are not synchronised one by one: after a loss of
power, the last of them may be missing, but the file is not damaged.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import apsw

from domain.timebase import Duration, Instant
from service.storage.sqlite.connection import SUFFIXES, open_to_write
from service.storage.trends.tiers import Tier

MEMORY = ":memory:"

VERSION = 1
"""Of the tables and of the bytes in them."""

_PER_BLOCK = 100
"""Bytes that a block takes besides its data, about."""

_AT_ONCE = 1_000
"""Blocks that are deleted at most with one write."""


class ForeignVersionError(Exception):
    """A file that a newer version of Pilothouse wrote."""

    def __init__(self, path: str, version: int) -> None:
        super().__init__(f"{path} has version {version}; this Pilothouse knows {VERSION}")


@dataclass(frozen=True, slots=True)
class Block:
    """Rows of one signal and one tier, packed."""

    signal: int
    """Number of the signal in this file."""
    from_at: Instant
    """Time of its first row, rounded down to the unit of the tier."""
    to_at: Instant
    """Time of its last reading."""
    rows: int
    errors: str
    """JSON list of the errors in it, in the order in which the data counts them."""
    data: bytes


class BlockFile:
    """An open file."""

    def __init__(self, path: str, tiers: Sequence[Tier]) -> None:
        """Open or make it.

        Args:
            path: Of the file, or `MEMORY`.
            tiers: From fine to coarse.

        Raises:
            ForeignVersionError: It is of a newer version.
            apsw.Error: It cannot be opened, or is no such file.
            OSError: It cannot be created.
        """
        self._tiers = tuple(tiers)
        in_memory = path == MEMORY
        self._connection = apsw.Connection(path) if in_memory else open_to_write(Path(path))
        try:
            self._prepare(path)
            self._bytes = {tier.name: self._measured(tier) for tier in tiers}
        except BaseException:
            self.close()
            raise

    @property
    def size(self) -> int:
        """Return how many bytes the blocks take, about."""
        return sum(self._bytes.values())

    def close(self) -> None:
        """Close the file; what a disk makes fail meanwhile is of no consequence."""
        with suppress(apsw.Error):
            self._connection.close(True)

    def numbers(self, identities: Sequence[str]) -> dict[str, int]:
        """Return the numbers of all signals in the file by identity, after new ones were added.

        Raises:
            apsw.Error: They cannot be written.
        """
        with self._connection as connection:
            connection.executemany(
                "INSERT OR IGNORE INTO signals(identity) VALUES (?)",
                [(identity,) for identity in identities],
            )
        return dict(self._connection.execute("SELECT identity, id FROM signals"))

    def write(self, tier: int, blocks: Sequence[Block], ran: Duration) -> None:
        """Add blocks of one tier, all or none, and delete those that were kept long enough.

        Args:
            tier: Index of the tier.
            blocks: To be added; they hold all that the tier below has blocks of.
            ran: Running time that is recorded in the file and before.

        Raises:
            apsw.Error: They cannot be written.
        """
        name = self._tiers[tier].name
        upto = self._newest(self._tiers[tier - 1]) if tier else 0
        size, freed = self._bytes[name] + sum(map(_size, blocks)), 0
        with self._connection as connection:
            connection.executemany(
                f"INSERT INTO {name}(signal, from_at, to_at, bytes, rows, ran, upto, errors, data)"
                " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
                [
                    (b.signal, b.from_at, b.to_at, _size(b), b.rows, ran, upto, b.errors, b.data)
                    for b in blocks
                ],
            )
            freed = self._free(self._tiers[tier], size, ran)
        self._bytes[name] = size - freed

    def ran(self) -> Duration:
        """Return the running time that is recorded."""
        found = (
            self._value(f"SELECT ran FROM {tier.name} ORDER BY id DESC LIMIT 1")
            for tier in self._tiers
        )
        return max(value or 0 for value in found)

    def oldest(self, tier: int, signal: int) -> Instant | None:
        """Return the time of the oldest row of a signal in a tier; None: there is none."""
        name = self._tiers[tier].name
        return self._value(f"SELECT min(from_at) FROM {name} WHERE signal = ?", (signal,))

    def read(self, tier: int, signal: int, from_at: Instant, to_at: Instant) -> Iterator[Block]:
        """Yield the blocks that overlap a time, in the order in which they were written."""
        bound = (signal, from_at, to_at)
        return self._blocks(tier, "signal = ? AND to_at >= ? AND from_at <= ?", bound)

    def not_in_next(self, tier: int) -> Iterator[Block]:
        """Yield the blocks of a tier that are in no block of the next one."""
        name = self._tiers[tier + 1].name
        upto = self._value(f"SELECT upto FROM {name} ORDER BY id DESC LIMIT 1")
        return self._blocks(tier, "id > ?", (upto or 0,))

    def _blocks(self, tier: int, condition: str, bound: Sequence[int]) -> Iterator[Block]:
        found = self._connection.execute(
            "SELECT signal, from_at, to_at, rows, errors, data"
            f" FROM {self._tiers[tier].name} WHERE {condition} ORDER BY id",
            bound,
        )
        return (Block(*row) for row in found)

    def _prepare(self, path: str) -> None:
        run = self._connection.execute
        version = self._value("PRAGMA user_version") or 0
        if version > VERSION:
            raise ForeignVersionError(path, version)
        run("PRAGMA synchronous = NORMAL")
        run("PRAGMA wal_autocheckpoint = 1000")
        with self._connection:
            run(
                "CREATE TABLE IF NOT EXISTS signals"
                "(id INTEGER PRIMARY KEY, identity TEXT NOT NULL UNIQUE)"
            )
            for tier in self._tiers:
                # Numbers are never used twice: a coarser block names the last finer one in it.
                run(
                    f"CREATE TABLE IF NOT EXISTS {tier.name}"
                    "(id INTEGER PRIMARY KEY AUTOINCREMENT, signal INTEGER NOT NULL,"
                    " from_at INTEGER NOT NULL, to_at INTEGER NOT NULL, bytes INTEGER NOT NULL,"
                    " rows INTEGER NOT NULL, ran INTEGER NOT NULL, upto INTEGER NOT NULL,"
                    " errors TEXT NOT NULL, data BLOB NOT NULL)"
                )
                run(
                    f"CREATE INDEX IF NOT EXISTS {tier.name}_by_time"
                    f" ON {tier.name}(signal, from_at, to_at, bytes)"
                )
            run(f"PRAGMA user_version = {VERSION}")

    def _measured(self, tier: Tier) -> int:
        return self._value(f"SELECT sum(bytes) FROM {tier.name}") or 0

    def _newest(self, tier: Tier) -> int:
        return self._value(f"SELECT id FROM {tier.name} ORDER BY id DESC LIMIT 1") or 0

    def _free(self, tier: Tier, size: int, ran: Duration) -> int:
        """Delete the oldest blocks of a tier, and return how many bytes they took."""
        last, freed = None, 0
        for number, size_of_block, written in self._connection.execute(
            f"SELECT id, bytes, ran FROM {tier.name} ORDER BY id LIMIT {_AT_ONCE}"
        ):
            if ran - written <= tier.keep_for and size - freed <= tier.keep_bytes:
                break
            last, freed = number, freed + size_of_block
        if last is not None:
            self._connection.execute(f"DELETE FROM {tier.name} WHERE id <= ?", (last,))
        return freed

    def _value(self, query: str, bound: Sequence[int] = ()) -> int | None:
        for (value,) in self._connection.execute(query, bound):
            return None if value is None else int(value)
        return None


def set_aside(path: str) -> Path:
    """Rename a file that cannot be used, with what belongs to it, and return its new name.

    Raises:
        OSError: It cannot be renamed.
    """
    stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%S.%fZ")
    aside = Path(f"{path}.broken-{stamp}")
    for suffix in SUFFIXES:
        part = Path(f"{path}{suffix}")
        if part.exists():
            part.rename(f"{aside}{suffix}")
    return aside


def _size(block: Block) -> int:
    return len(block.data) + _PER_BLOCK
