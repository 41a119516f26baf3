"""Errors of parts that drivers report on a topic of diagnostics."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

from domain.actor import Actor
from domain.inputs import ErrorReport
from domain.snapshot import ErrorKey
from service.files.ros2_block import DiagnosticsBlock, error_named
from service.ros.graph.graph import Lane, Message, Qos, RosGraph

NODE = "pilothouse_diagnostics"
TYPE = "diagnostic_msgs/msg/DiagnosticArray"

_LEVELS = ("OK", "WARN", "ERROR", "STALE")
_OK = 0


class _Status(NamedTuple):
    """What one status says."""

    level: int
    message: str


class ReportedDiagnostics:
    """Delivers a report whenever the level of an error changes.

    What a status says in words and values changes with each message; the report has what it said
    when its level changed. A status that falls silent keeps its level: no news is not bad news. Who
    wants to notice that watches the rate of the topic.
    """

    def __init__(self, settings: DiagnosticsBlock | None, graph: RosGraph) -> None:
        self._settings = settings
        self._graph = graph
        self._errors: dict[str, ErrorKey] = {}
        """The error of each status that is listened to."""
        self._statuses: dict[ErrorKey, dict[str, _Status]] = {}
        """What each status of an error said last."""
        self._told: dict[ErrorKey, int] = {}
        """The levels that were delivered."""
        for status, name in settings.errors.items() if settings else ():
            key = self._errors[status] = ErrorKey(*error_named(name))
            self._statuses[key] = {}

    def start(self, deliver: Callable[[ErrorReport], None]) -> None:
        """Listen while the graph is open.

        Raises:
            UnknownTypeError: The type of the topic is not installed.
        """
        if self._settings is None:
            return
        node = self._graph.node(NODE, Lane.SENSORS)
        topic = self._settings.topic
        take = partial(self._take, Actor("ros", way="ros2", address=topic), deliver)
        node.subscribe(topic, TYPE, Qos.EVENTS, self._pick, take)

    def _pick(self, array: Message) -> tuple[tuple[str, _Status], ...] | None:
        """Return the statuses that are listened to; on the thread of ROS."""
        found = tuple(
            (status.name, _Status(_level(status.level), status.message))
            for status in array.status
            if status.name in self._errors
        )
        return found or None

    def _take(
        self,
        actor: Actor,
        deliver: Callable[[ErrorReport], None],
        statuses: tuple[tuple[str, _Status], ...],
    ) -> None:
        touched: dict[ErrorKey, None] = {}
        for name, status in statuses:
            key = self._errors[name]
            self._statuses[key][name] = status
            touched[key] = None
        for report in self._news(touched, actor):
            deliver(report)

    def _news(self, keys: dict[ErrorKey, None], actor: Actor) -> Iterator[ErrorReport]:
        """Yield a report for each error whose level is not the one that was told."""
        for key in keys:
            name, worst = max(self._statuses[key].items(), key=lambda item: item[1].level)
            if self._told.get(key) == worst.level:
                continue
            self._told[key] = worst.level
            words = f"{name}: {_LEVELS[worst.level]}: {worst.message}"
            is_bad = worst.level != _OK
            yield ErrorReport(key.part, key.error, is_bad, words if is_bad else "", actor=actor)


def _level(level: int | bytes) -> int:
    """Return a level as a number; rclpy has a `byte` as bytes. One that is not known is stale."""
    number = level[0] if isinstance(level, bytes) else level
    return min(number, len(_LEVELS) - 1)
