"""Prometheus metrics of the stream."""

from collections.abc import Iterator

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector

from api.streaming.stream_server import StreamServer


class StreamCollector(Collector):
    """Number of clients, dropped clients and skipped frames."""

    def __init__(self, hub: StreamServer) -> None:
        self._hub = hub

    def collect(self) -> Iterator[Metric]:
        """Yield the metrics as they are now."""
        yield GaugeMetricFamily(
            "pilothouse_ws_clients", "Clients of the stream", value=self._hub.clients
        )
        yield CounterMetricFamily(
            "pilothouse_ws_dropped",
            "Clients dropped because they read too slowly",
            value=self._hub.fan_out.dropped,
        )
        yield CounterMetricFamily(
            "pilothouse_ws_frames_skipped",
            "Frames skipped because clients read too slowly",
            value=self._hub.fan_out.skipped,
        )
