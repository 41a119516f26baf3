"""The last facts about the nodes and signals of a device, on both ends of the link."""

from collections.abc import Iterator
from dataclasses import replace
from types import MappingProxyType
from typing import TypeVar

from domain.inputs import (
    ErrorReport,
    NodeReport,
    ReactionReport,
    Reading,
    Readings,
    SourceFault,
)
from domain.lifecycle import LifecycleState
from domain.link.messages import Told
from domain.parameters import Parameters, same_value
from domain.state_and_mode import PartName
from domain.timebase import Instant

FactT = TypeVar("FactT")

_MAX_OTHERS = 4_096
"""Readings, faults of sources and errors that are remembered at most, of each kind."""


class Facts:
    """What was reported last: of nodes, signals by their sources, errors and reactions.

    Answers and checkpoints are of a moment, and are not kept.
    """

    def __init__(self) -> None:
        """Begin without a fact."""
        self.nodes: dict[PartName, NodeReport] = {}
        self._readings: dict[tuple[str, str], tuple[Readings, Instant]] = {}
        """By source and signal, with one reading each, and when it came."""
        self._faults: dict[tuple[str, str], SourceFault] = {}
        self._errors: dict[tuple[PartName | None, str], ErrorReport] = {}
        self._reactions: dict[str, ReactionReport] = {}

    def note(self, told: Told, now: Instant) -> None:
        """Note what was reported."""
        match told:
            case NodeReport():
                self.nodes[told.node] = merged(self.nodes.get(told.node), told)
            case Readings():
                for reading in told.items:
                    key = (told.source, reading.signal)
                    self._faults.pop(key, None)
                    if key in self._readings or len(self._readings) < _MAX_OTHERS:
                        self._readings[key] = (replace(told, items=(reading,)), now)
            case SourceFault():
                key = (told.source, told.signal)
                if key in self._faults or len(self._faults) < _MAX_OTHERS:
                    self._faults[key] = told
            case ErrorReport():
                error = (told.part, told.error)
                if error in self._errors or len(self._errors) < _MAX_OTHERS:
                    self._errors[error] = told
            case ReactionReport():
                if told.reaction in self._reactions or len(self._reactions) < _MAX_OTHERS:
                    self._reactions[told.reaction] = told
            case _:
                pass

    def all(self) -> Iterator[Told]:
        """Yield everything; readings that were not stamped have the time at which they came."""
        yield from self.nodes.values()
        yield from self.others()

    def others(self) -> Iterator[Told]:
        """Yield everything but the facts of nodes."""
        for readings, came_at in self._readings.values():
            (reading,) = readings.items
            stamp = came_at if reading.stamp is None else reading.stamp
            yield replace(readings, items=(replace(reading, stamp=stamp),))
        yield from self._faults.values()
        yield from self._errors.values()
        yield from self._reactions.values()

    def reading(self, source: str, signal: str) -> tuple[Reading, Instant] | None:
        """Return the last reading of a signal from a source, and when it came; None: none."""
        known = self._readings.get((source, signal))
        return None if known is None else (known[0].items[0], known[1])

    def __contains__(self, told: Told) -> bool:
        """Tell whether a fault of a source, an error or a reaction is as it was reported last."""
        match told:
            case SourceFault():
                return self._faults.get((told.source, told.signal)) == told
            case ErrorReport():
                return self._errors.get((told.part, told.error)) == told
            case ReactionReport():
                return self._reactions.get(told.reaction) == told
            case _:
                return False


def merged(known: NodeReport | None, report: NodeReport) -> NodeReport:
    """Return all facts about a node, after a report; see `NodeFacts.take`."""
    if known is None:
        known = NodeReport(report.node)
    reachable = report.reachable
    if reachable is None:
        reachable = True if known.reachable is None else known.reachable
    leaves = report.state is not None and report.state is not LifecycleState.ACTIVE
    parameters = known.parameters
    if report.parameters is not None:
        parameters = MappingProxyType({**(parameters or {}), **report.parameters})
    return NodeReport(
        report.node,
        report.state if report.state is not None else known.state,
        report.mode if report.mode is not None else None if leaves else known.mode,
        parameters,
        reachable,
        known.has_lifecycle if report.has_lifecycle is None else report.has_lifecycle,
    )


def difference(known: NodeReport | None, complete: NodeReport) -> NodeReport | None:
    """Return what must be reported for complete facts to be known; None: nothing.

    Args:
        known: All that is known of the node; None: nothing is.
        complete: All facts about it.
    """
    if known is None or known.reachable is False:
        return complete if known is None or complete.reachable is not False else None
    changed = NodeReport(
        complete.node,
        _new(known.state, complete.state),
        _new(known.mode, complete.mode),
        _new_values(known.parameters or {}, complete.parameters or {}) or None,
        _new(known.reachable, complete.reachable),
        _new(known.has_lifecycle, complete.has_lifecycle),
    )
    return None if changed == NodeReport(complete.node) else changed


def _new(known: FactT | None, now: FactT | None) -> FactT | None:
    return None if now == known else now


def _new_values(known: Parameters, now: Parameters) -> Parameters:
    return {
        name: value
        for name, value in now.items()
        if name not in known or not same_value(known[name], value)
    }
