"""Prometheus metrics of the connections to the other computers of the robot."""

from collections.abc import Iterable, Iterator, Mapping
from typing import TypeAlias

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector

from domain.computers import SUPERVISOR, ComputerName, Connection
from domain.timebase import Instant, to_seconds
from service.supervisor import Supervisor

_Values: TypeAlias = Iterable[tuple[ComputerName, float | None]]


class DeviceCollector(Collector):
    """How the connections to the other computers are doing."""

    def __init__(self, supervisor: Supervisor) -> None:
        self._supervisor = supervisor

    def collect(self) -> Iterator[Metric]:
        """Yield the metrics as they are now; without samples for a robot of one computer."""
        supervisor = self._supervisor
        is_connected = {name: view.is_connected for name, view in supervisor.core.devices().items()}
        others = dict.fromkeys(is_connected) or dict.fromkeys(_lead_of(supervisor))
        connections = {name: supervisor.connection(name) for name in others}
        return device_metrics(is_connected, connections, supervisor.clock.now())


def device_metrics(
    is_connected: Mapping[ComputerName, bool],
    connections: Mapping[ComputerName, Connection],
    now: Instant,
) -> Iterator[Metric]:
    """Yield the metrics of devices.

    Args:
        is_connected: By device, whether it can be commanded.
        connections: By computer; of a device, that to its supervisor.
        now: The current time.
    """
    yield _gauge(
        "pilothouse_device_connected",
        "1 for each device that is heard and can be commanded, else 0",
        ((name, float(connected)) for name, connected in is_connected.items()),
    )
    yield _gauge(
        "pilothouse_device_round_trip_seconds",
        "Time from a sign of life to the one of the other computer that echoes it",
        (
            (name, None if each.round_trip is None else to_seconds(each.round_trip))
            for name, each in connections.items()
        ),
    )
    yield _gauge(
        "pilothouse_device_lost_ratio",
        "Share of the signs of life of the last seconds that did not come, 0 to 1",
        ((name, each.lost_share) for name, each in connections.items()),
    )
    yield _gauge(
        "pilothouse_device_heard_age_seconds",
        "Age of the lease: time since the other computer was last heard; absent before that",
        (
            (name, None if each.heard_at is None else to_seconds(now - each.heard_at))
            for name, each in connections.items()
        ),
    )
    dropped = CounterMetricFamily(
        "pilothouse_device_messages_dropped",
        "Messages of another computer that were too many, too long or unreadable",
        labels=["device"],
    )
    for name, each in connections.items():
        dropped.add_metric([name], each.dropped)
    yield dropped


def _lead_of(supervisor: Supervisor) -> tuple[ComputerName, ...]:
    """Return the supervisor of a device; nothing for a robot of one computer."""
    return () if supervisor.link is None else (SUPERVISOR,)


def _gauge(name: str, about: str, values: _Values) -> GaugeMetricFamily:
    family = GaugeMetricFamily(name, about, labels=["device"])
    for computer, value in values:
        if value is not None:
            family.add_metric([computer], value)
    return family
