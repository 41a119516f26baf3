"""When frames arrived at clients, and which of them did not."""

import re
import time
from array import array
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from tests.support.bench import quantiles

_STAMP = re.compile(rb'\{"type":"state","seq":(\d+),"at":"([^"]+)"')
_STAMP_BYTES = 58
_STAMPS_KEPT = 1_000


@dataclass(slots=True)
class _Stamp:
    """What a frame says of itself, and when the first client had it, s since 1970."""

    seq: int
    at: float
    first: float


class Arrivals:
    """Delays of frames behind their own time, and behind the first client that had them."""

    def __init__(self) -> None:
        self._now = 0.0
        self._stamps: dict[bytes, _Stamp | None] = {}
        self._by_seq: dict[int, _Stamp] = {}
        self._noting = False
        self._reset()

    def come(self) -> None:
        """Take the time, for all frames that are noted until the next call."""
        self._now = time.time()

    def note(self, frame: bytes, offset: int, seq: int | None) -> int | None:
        """Note a frame whose payload begins at `offset`.

        Args:
            frame: With its header.
            offset: Where the payload begins.
            seq: Number of the frame before at the same client.

        Returns:
            Its number, or `seq` where it has none.
        """
        head = frame[offset : offset + _STAMP_BYTES]
        stamp = self._stamps[head] if head in self._stamps else self._learn(head)
        if stamp is None:
            return seq
        if self._noting:
            self._delays.append(self._now - stamp.at)
            self._spreads.append(self._now - stamp.first)
            self._bytes += len(frame) - offset
            if seq is not None:
                self._lost += stamp.seq - seq - 1
        return stamp.seq

    def begin(self) -> None:
        """Begin to note."""
        self._reset()
        self._noting = True

    def end(self) -> dict[str, Any]:
        """Stop to note, and return what was found."""
        self._noting = False
        count = len(self._delays)
        return {
            "frames": count,
            "lost": self._lost,
            "frame_bytes": self._bytes / max(1, count),
            "delay": quantiles(self._delays) if count else {},
            "spread": quantiles(self._spreads) if count else {},
        }

    def _reset(self) -> None:
        self._delays = array("d")
        self._spreads = array("d")
        self._lost = 0
        self._bytes = 0

    def _learn(self, head: bytes) -> _Stamp | None:
        """Read a beginning that no client had yet; None: it is of no frame with a number."""
        found = _STAMP.match(head)
        stamp = None
        if found:
            seq = int(found[1])
            at = datetime.fromisoformat(found[2].decode()).timestamp()
            stamp = self._by_seq.setdefault(seq, _Stamp(seq, at, self._now))
        if len(self._stamps) > _STAMPS_KEPT:
            self._stamps.clear()
            self._by_seq.clear()
        self._stamps[head] = stamp
        return stamp
