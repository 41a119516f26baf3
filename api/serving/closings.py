"""Connections that the service closed of its own accord: counted, and logged at a limited rate."""

import logging
from collections import Counter
from collections.abc import Iterator

from prometheus_client.core import CounterMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector

log = logging.getLogger(__name__)

REASONS = ("head", "body", "unread", "full", "malformed", "frames")
"""Slow head, slow body, an answer that is not read, room for a new connection, something that is
not HTTP, frames that a client without a token may not send."""
_LOG_EVERY_S = 1.0


class Closings:
    """Counts by reason; at most one log line per second and reason."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self._quiet_until: dict[str, float] = {}
        self._untold: Counter[str] = Counter()

    def note(self, reason: str, address: str, now: float) -> None:
        """Count a connection, and log it if none was for this reason in the last second.

        Args:
            reason: One of `REASONS`.
            address: Of the client.
            now: Of the loop, s.
        """
        self.counts[reason] += 1
        if now < self._quiet_until.get(reason, now):
            self._untold[reason] += 1
            return
        self._quiet_until[reason] = now + _LOG_EVERY_S
        more = self._untold.pop(reason, 0)
        untold = f", and {more} more since the last line" if more else ""
        log.warning("closed a connection of %s: %s%s", address, reason, untold)


class ClosingsCollector(Collector):
    """The counts as a metric."""

    def __init__(self, closings: Closings) -> None:
        self._closings = closings

    def collect(self) -> Iterator[Metric]:
        """Yield the metric as it is now."""
        closed = CounterMetricFamily(
            "pilothouse_connections_closed",
            "Connections that the service closed, by reason: head or body that came too slowly, "
            "unread answer, full (to admit a new one), malformed request, frames before the token",
            labels=["reason"],
        )
        for reason in REASONS:
            closed.add_metric([reason], self._closings.counts[reason])
        yield closed
