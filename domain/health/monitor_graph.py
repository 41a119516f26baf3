"""Which signals monitors are computed from, and what is wrong with that."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from domain.errors import near_match
from domain.health.signals import MonitorSettings, SignalKind, SignalSettings, SignalSpec
from domain.inputs import SignalValue
from domain.windows.settings import OF_ARRIVALS, Statistic

NOT_CHAINED = frozenset({Statistic.AGE, Statistic.GAP, Statistic.STUCK_FOR})
"""Statistics of which there is no use in one value per reading: silence makes them."""

_OF_ANY_KIND = OF_ARRIVALS | {Statistic.STUCK_FOR}
"""Statistics of what is no number."""


class MonitorFault(NamedTuple):
    """Why a monitor cannot be computed."""

    signal: str
    key: str
    """The key of its settings."""
    code: str
    message: str


def faults_of_monitors(signals: Sequence[SignalSettings]) -> Iterator[MonitorFault]:
    """Yield what is wrong with the monitors among signals."""
    by_name = {signal.spec.name: signal for signal in signals}
    for signal in signals:
        if signal.monitor is not None:
            yield from _faults(signal.spec.name, signal.monitor, by_name)


def fed_by(signals: Sequence[SignalSettings]) -> Mapping[str, tuple[str, ...]]:
    """Return by signal the monitors that its readings go to, in the order of declaration."""
    fed: dict[str, tuple[str, ...]] = {}
    for signal in signals:
        if signal.monitor is not None:
            fed[signal.monitor.of] = (*fed.get(signal.monitor.of, ()), signal.spec.name)
    return fed


def number_of(spec: SignalSpec, value: SignalValue) -> float:
    """Return a value as a window takes it: false and true as 0 and 1, a member as its place."""
    return float(spec.members.index(value) if isinstance(value, str) else value)


def _faults(
    name: str, monitor: MonitorSettings, by_name: Mapping[str, SignalSettings]
) -> Iterator[MonitorFault]:
    source, statistic = by_name.get(monitor.of), monitor.window.statistic
    if source is None:
        near = near_match(monitor.of, tuple(by_name))
        hint = f"; did you mean {near}?" if near else ""
        message = f"there is no signal {monitor.of!r}{hint}"
        yield MonitorFault(name, "of", "UNKNOWN_SIGNAL", message)
    elif circle := _circle(name, by_name):
        message = f"computed from itself: {' of '.join(circle)}"
        yield MonitorFault(name, "of", "MONITOR_CYCLE", message)
    elif source.monitor is not None and source.monitor.window.statistic in NOT_CHAINED:
        kind = source.monitor.window.statistic
        message = f"{monitor.of} is the {kind} of a signal, which no monitor can be computed from"
        yield MonitorFault(name, "of", "NOT_CHAINABLE", message)
    elif source.spec.kind is SignalKind.ENUMERATION and statistic not in _OF_ANY_KIND:
        message = f"{monitor.of} is no number: it has no {statistic}"
        yield MonitorFault(name, "statistic", "WRONG_TYPE", message)


def _circle(name: str, by_name: Mapping[str, SignalSettings]) -> list[str]:
    """Return the monitors that a monitor leads back to itself through; empty: it does not."""
    way = [name]
    while (source := by_name.get(way[-1])) is not None and source.monitor is not None:
        way.append(source.monitor.of)
        if way[-1] == name:
            return way
        if way[-1] in way[:-1]:
            break
    return []
