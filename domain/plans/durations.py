"""How long the steps of nodes take, from those that were done before."""

from array import array
from statistics import median

from domain.state_and_mode import PartName
from domain.timebase import Duration

MOST_KEPT = 20
"""Times of one node and action."""


class Durations:
    """The last times of each node and action."""

    def __init__(self) -> None:
        """Begin without any."""
        self._times: dict[tuple[PartName, str], array[int]] = {}

    def note(self, node: PartName, action: str, took: Duration) -> None:
        """Note how long a step took that succeeded."""
        times = self._times.get((node, action))
        if times is None:
            times = self._times[node, action] = array("q")
        times.append(took)
        del times[:-MOST_KEPT]

    def expected(self, node: PartName, action: str) -> Duration | None:
        """Return how long a step is expected to take; None: it was never done."""
        times = self._times.get((node, action))
        return None if times is None else round(median(times))
