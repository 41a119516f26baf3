"""The signals that the core of a device has: those that are read there, and monitors of them."""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace

from domain.health.signals import ESTOP_SIGNAL, SignalSettings
from domain.state_and_mode import PartName


def readable_signals(
    signals: Iterable[SignalSettings], read: Collection[str]
) -> tuple[SignalSettings, ...]:
    """Return the signals that are read at a device, and the monitors that rest on nothing else.

    Args:
        signals: All signals of the robot.
        read: Names of those that are read there.
    """
    by_name = {signal.spec.name: signal for signal in signals}

    def is_there(signal: SignalSettings) -> bool:
        seen = set[str]()
        while signal.monitor is not None:
            if signal.spec.name in seen or signal.monitor.of not in by_name:
                return False
            seen.add(signal.spec.name)
            signal = by_name[signal.monitor.of]
        return signal.spec.name in read

    return tuple(signal for signal in by_name.values() if is_there(signal))


def signals_of_device(
    signals: Iterable[SignalSettings], read: Collection[str], parts: Collection[PartName]
) -> tuple[SignalSettings, ...]:
    """Return the signals of a device's core, each with the errors that are found there.

    Errors of parts that are not the device's own are found at the supervisor. The stop is always
    there, since every computer can be stopped; where nobody reads it, it never goes stale. What a
    device does not have cannot go stale either: it is no error there that there is no GPS.

    Args:
        signals: All signals of the robot.
        read: Names of those that are read there.
        parts: All parts of the device.
    """
    return tuple(_of_device(signals, read, parts))


def _of_device(
    signals: Iterable[SignalSettings], read: Collection[str], parts: Collection[PartName]
) -> Iterator[SignalSettings]:
    every = tuple(signals)
    readable = {signal.spec.name for signal in readable_signals(every, read)}
    for signal in every:
        if signal.spec.name in readable:
            yield _with_own_errors(signal, parts)
        elif signal.spec.name == ESTOP_SIGNAL:
            yield replace(signal, stale_after=0)


def _with_own_errors(signal: SignalSettings, parts: Collection[PartName]) -> SignalSettings:
    """Return a signal that judges its values only by what the device itself knows."""
    named = [signal.part, *(limit.part for limit in signal.limits)]
    if all(part is None or part in parts for part in named):
        return signal
    return replace(signal, bounds=(), limits=(), part=None)
