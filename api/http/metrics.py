"""Prometheus metrics, read from the supervisor when they are scraped."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice

from prometheus_client import CollectorRegistry, Histogram
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector

from api.http.device_metrics import DeviceCollector
from api.http.gate.refusals import COUNTED, Refusals
from domain.reaction_terms import ReactionState
from domain.snapshot import ChangeStatus, Severity, SystemState
from domain.timebase import to_seconds
from service.refused_readings import WAYS
from service.source_status import SourceStatus
from service.supervisor import Supervisor

_MAX_PARTS = 1_000
"""Limits the size of a scrape."""

_ENDS = tuple(str(status) for status in ChangeStatus if status.is_final)

_PERIODS_S = (0.025, 0.045, 0.049, 0.05, 0.051, 0.055, 0.075, 0.1, 0.2, 1.0)
"""Close together about the 50 ms of the tick."""


class Metrics:
    """The metrics of one service, in a registry of their own."""

    def __init__(self, supervisor: Supervisor, refusals: Refusals) -> None:
        """Register the metrics of robot, service and gate; other packages add their own."""
        self.registry = CollectorRegistry(auto_describe=False)
        period = Histogram(
            "pilothouse_publish_period_seconds",
            "Period of the publishing tick",
            buckets=_PERIODS_S,
            registry=self.registry,
        )
        supervisor.publisher.on_tick.append(period.observe)
        self.registry.register(_RobotCollector(supervisor))
        self.registry.register(DeviceCollector(supervisor))
        self.registry.register(_ServiceCollector(supervisor))
        self.registry.register(_GateCollector(refusals))


class _RobotCollector(Collector):
    """The state of the robot."""

    def __init__(self, supervisor: Supervisor) -> None:
        self._supervisor = supervisor

    def collect(self) -> Iterator[Metric]:
        core = self._supervisor.core
        view = core.system_state()
        yield _gauge(
            "pilothouse_system_state",
            "1 for the current system state",
            "state",
            ((str(state), float(state is view.state)) for state in SystemState),
        )
        yield from self._problems()
        deviating = (name for name, part in core.parts().items() if not part.converged)
        yield _gauge(
            "pilothouse_part_deviates",
            f"1 for each part whose actual state deviates from its target; at most {_MAX_PARTS}",
            "part",
            ((str(name), 1.0) for name in islice(deviating, _MAX_PARTS)),
        )
        yield from self._driving()
        now = self._supervisor.clock.now()
        yield _gauge(
            "pilothouse_signal_age_seconds",
            "Time since the last reading of a signal; absent before the first one",
            "signal",
            (
                (name, to_seconds(now - signal.received_at))
                for name, signal in core.signals().items()
                if signal.received_at is not None
            ),
        )

    def _problems(self) -> Iterator[Metric]:
        core = self._supervisor.core
        yield _gauge(
            "pilothouse_error_active",
            "1 for each active error",
            "error",
            ((error, 1.0) for error in core.system_state().errors),
        )
        yield _gauge(
            "pilothouse_part_errors",
            "Number of parts that have an error, by error",
            "error",
            ((error, float(count)) for error, count in core.parts_with_errors.items()),
        )
        on = Counter(view.severity for view in core.open_errors().values() if view.state.is_on)
        yield _gauge(
            "pilothouse_errors",
            "Number of errors that are on, of the robot and of its parts, by severity",
            "severity",
            ((str(severity), float(on[severity])) for severity in Severity),
        )
        reactions = Counter(view.state for view in core.reactions().values())
        yield _gauge(
            "pilothouse_reactions",
            "Number of reactions, by how they stand",
            "state",
            ((str(state), float(reactions[state])) for state in ReactionState),
        )

    def _driving(self) -> Iterator[Metric]:
        driving = self._supervisor.core.driving
        yield _gauge(
            "pilothouse_hold_active",
            "1 for each hold in force",
            "owner",
            ((owner, 1.0) for owner in driving.holds),
        )
        task = driving.current_task
        if task is None:
            return
        yield GaugeMetricFamily(
            "pilothouse_task_progress_ratio",
            "Progress of the current task along its path, 0 to 1",
            value=task.progress,
        )
        if task.cross_track_error_m is not None:
            yield GaugeMetricFamily(
                "pilothouse_cross_track_error_meters",
                "Cross-track error; positive: left of the path",
                value=task.cross_track_error_m,
            )


class _ServiceCollector(Collector):
    """The state of the service."""

    def __init__(self, supervisor: Supervisor) -> None:
        self._supervisor = supervisor

    def collect(self) -> Iterator[Metric]:
        yield CounterMetricFamily(
            "pilothouse_ticks_late",
            "Skipped ticks",
            value=self._supervisor.publisher.late_ticks,
        )
        changes = CounterMetricFamily(
            "pilothouse_changes", "Ended changes, by final status", labels=["status"]
        )
        for status in _ENDS:
            changes.add_metric([status], self._supervisor.change_ends.counts[status])
        yield changes
        refused = CounterMetricFamily(
            "pilothouse_readings_refused", "Rejected readings, by way in", labels=["way"]
        )
        for way in WAYS:
            refused.add_metric([way], self._supervisor.refused_readings.counts[way])
        yield refused
        yield from _of_sources(self._supervisor.sources)
        yield from self._storage()

    def _storage(self) -> Iterator[Metric]:
        status = self._supervisor.storage
        yield GaugeMetricFamily(
            "pilothouse_storage_degraded",
            "1 while what happens cannot be written down",
            value=float(status.reason is not None),
        )
        yield GaugeMetricFamily(
            "pilothouse_storage_bytes", "Size of the folder of the robot", value=status.bytes
        )
        lost = CounterMetricFamily(
            "pilothouse_storage_lost", "What could not be written down, by log", labels=["log"]
        )
        lost.add_metric(["inputs"], status.lost_inputs)
        lost.add_metric(["events"], status.lost_events)
        yield lost


def _of_sources(sources: Sequence[SourceStatus]) -> Iterator[Metric]:
    read = CounterMetricFamily(
        "pilothouse_source_reads", "Accepted readings, by source", labels=["source"]
    )
    failed = CounterMetricFamily(
        "pilothouse_source_failures",
        "Readings that a source could not give, or that were rejected, by source",
        labels=["source"],
    )
    for source in sources:
        read.add_metric([source.name], source.reads)
        failed.add_metric([source.name], source.failures)
    yield read
    yield failed
    yield _gauge(
        "pilothouse_source_duration_seconds",
        "Time that the last measurement of a source took",
        "source",
        (
            (source.name, to_seconds(source.duration))
            for source in sources
            if source.duration is not None
        ),
    )


class _GateCollector(Collector):
    """Rejected requests."""

    def __init__(self, refusals: Refusals) -> None:
        self._refusals = refusals

    def collect(self) -> Iterator[Metric]:
        refused = CounterMetricFamily(
            "pilothouse_requests_refused",
            "Requests and handshakes rejected before routing, by status: 401 missing or wrong "
            "token, 403 foreign origin or host, 429 rate limit of one address",
            labels=["status"],
        )
        for status in COUNTED:
            refused.add_metric([str(status.value)], self._refusals.counts[status])
        yield refused


def _gauge(
    name: str, about: str, label: str, values: Iterable[tuple[str, float]]
) -> GaugeMetricFamily:
    family = GaugeMetricFamily(name, about, labels=[label])
    for value_label, value in values:
        family.add_metric([value_label], value)
    return family
