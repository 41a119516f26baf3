"""Rows on their way to blocks: each tier gathers what the tier below has packed.

So every reading is exactly once in the blocks of a tier, or among the rows that wait in that tier
or in a finer one. A block of a tier holds whole blocks of the tier below: what waits when the
process is killed is derived again from these.
"""

from collections.abc import Callable, Sequence
from typing import TypeAlias

from domain.timebase import Duration, Instant, seconds
from service.storage.trends.rows import Rows, RowsBySignal, row_count
from service.storage.trends.tiers import Tier

Write: TypeAlias = Callable[[int, RowsBySignal], bool]
"""Packs and writes rows of the tier with an index; returns whether that succeeded."""

_PATIENCE = seconds(10.0)
"""Rows that cannot be written are tried again for so long, or for as long as a block takes."""


class Cascade:
    """The rows of each tier that are in none of its blocks yet."""

    def __init__(self, tiers: Sequence[Tier]) -> None:
        self._tiers = tiers
        self._waiting: list[dict[int, list[Rows]]] = [{} for _ in tiers]
        """By tier and signal, in the order of arrival."""
        self._since: list[Duration | None] = [None for _ in tiers]
        """Running time when the first of them came."""
        self.dropped = 0
        """Rows that could not be written; the next tier has got them all the same."""
        self._has_orphans = False
        """Whether rows wait whose readings are in no block of a finer tier."""

    def add(self, rows: RowsBySignal, ran: Duration, tier: int = 0) -> None:
        """Add rows to a tier.

        Args:
            rows: Not yet in any block of the tier.
            ran: Running time.
            tier: Index of the tier.
        """
        for signal, own in rows.items():
            self._waiting[tier].setdefault(signal, []).append(own)
        if rows and self._since[tier] is None:
            self._since[tier] = ran

    def settle(self, write: Write, ran: Duration) -> None:
        """Make blocks of what has waited long enough, and pass it on to the next tier.

        Args:
            write: Writes rows, by signal and merged.
            ran: Running time.
        """
        is_written = False
        for index, tier in enumerate(self._tiers):
            since = self._since[index]
            if since is not None and ran - since >= tier.block:
                is_last_try = ran - since - tier.block >= max(tier.block, _PATIENCE)
                is_written |= self._pack(index, write, is_last_try=is_last_try)
        if is_written and self._has_orphans:
            self._write_all(write)

    def finish(self, write: Write) -> None:
        """Make blocks of the single readings, and of what cannot be derived from these."""
        if self._has_orphans:
            self._write_all(write)
        elif self._since[0] is not None:
            self._pack(0, write, is_last_try=True)

    def rows_of(self, tier: int, number: int) -> list[Rows]:
        """Return what is in no block of a tier of a signal, in the order of arrival."""
        return [
            rows for index in range(tier, -1, -1) for rows in self._waiting[index].get(number, ())
        ]

    def oldest(self, tier: int, number: int) -> Instant | None:
        """Return the time of the oldest of those rows; None: there is none."""
        return min((min(rows.first) for rows in self.rows_of(tier, number)), default=None)

    def _write_all(self, write: Write) -> None:
        self._has_orphans = False
        for index in range(len(self._tiers)):
            if self._since[index] is not None and not self._pack(index, write, is_last_try=False):
                self._has_orphans = True

    def _pack(self, index: int, write: Write, *, is_last_try: bool) -> bool:
        """Make blocks of what waits in a tier; return whether they are written."""
        rows = {
            signal: Rows.joined(parts).in_buckets(self._tiers[index].width)
            for signal, parts in sorted(self._waiting[index].items())
        }
        self._waiting[index] = {signal: [own] for signal, own in rows.items()}
        is_written = write(index, rows)
        if not is_written and not is_last_try:
            return False
        if not is_written:
            self.dropped += row_count(rows)
            self._has_orphans = True
        since = self._since[index]
        self._waiting[index], self._since[index] = {}, None
        if index + 1 < len(self._tiers) and since is not None:
            width = self._tiers[index + 1].width
            coarser = {signal: own.in_buckets(width) for signal, own in rows.items()}
            self.add(coarser, since, index + 1)
        return is_written
