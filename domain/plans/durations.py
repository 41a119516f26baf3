"""How long the steps of nodes take, from those that were done before."""

import struct
from statistics import median

from domain.state_and_mode import PartName
from domain.timebase import Duration

MOST_KEPT = 20
"""Times of one node and action."""

_TIME = struct.Struct("<q")


class Durations:
    """The last times of each node and action."""

    def __init__(self) -> None:
        """Begin without any."""
        self._times: dict[tuple[PartName, str], bytes] = {}
        """Packed: a robot of ten thousand nodes has half a million of them."""

    def note(self, node: PartName, action: str, took: Duration) -> None:
        """Note how long a step took that succeeded."""
        times = self._times.get((node, action), b"") + _TIME.pack(took)
        self._times[node, action] = times[-MOST_KEPT * _TIME.size :]

    def expected(self, node: PartName, action: str) -> Duration | None:
        """Return how long a step is expected to take; None: it was never done."""
        times = self._times.get((node, action))
        if times is None:
            return None
        known: list[Duration] = [took for (took,) in _TIME.iter_unpack(times)]
        return round(median(known))
