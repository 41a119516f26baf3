"""Connections that the service closed of its own accord: counted and logged."""

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


class Closings:
    """Counts by reason; the log of the process limits its lines."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()

    def note(self, reason: str, address: str) -> None:
        """Count and log a connection.

        Args:
            reason: One of `REASONS`.
            address: Of the client.
        """
        self.counts[reason] += 1
        log.warning("closed a connection of %s: %s", address, reason)


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
