"""Limits by mode: which bound of a signal is in force follows from the modes that parts are in."""

from collections.abc import Iterable

from domain.concern import Concern
from domain.health.health import Health
from domain.health.signals import ModeLimit, SignalSettings
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.state_and_mode import PartName
from domain.timebase import Instant


class ModeLimits(Concern):
    """Swaps limits in the step in which the actual mode changes.

    Of several that apply, the first of the robot file is in force. While it is not known which
    mode a part is in that decides, the limits stay as they are.
    """

    def __init__(
        self, signals: Iterable[SignalSettings], parts: Parts, health: Health, outbox: Outbox
    ) -> None:
        """Prepare; the first `settle` looks at all parts.

        Args:
            signals: Those of the robot.
            parts: Whose modes decide.
            health: Holds the limits.
            outbox: Tells what the current input changed so far.
        """
        self._parts = parts
        self._health = health
        self._outbox = outbox
        self._limits = {item.spec.name: item.limits for item in signals if item.limits}
        self._in_force: dict[str, ModeLimit | None] = {
            signal: _default(limits) for signal, limits in self._limits.items()
        }
        self._signals_of: dict[PartName, list[str]] = {}
        """By part, the signals whose limits its mode decides."""
        for signal, limits in self._limits.items():
            for part in dict.fromkeys(limit.part for limit in limits if limit.part is not None):
                self._signals_of.setdefault(part, []).append(signal)
        self._is_new = bool(self._limits)

    def settle(self, now: Instant) -> bool:
        """Swap the limits that the modes of changed parts decide; return whether any were."""
        if self._is_new:
            self._is_new = False
            return self._swap(list(self._limits), now)
        if not self._limits or not self._outbox.parts:
            return False
        changed = [part for part in self._signals_of if part in self._outbox.parts]
        affected = [signal for part in changed for signal in self._signals_of[part]]
        return self._swap(list(dict.fromkeys(affected)), now)

    def _swap(self, signals: list[str], now: Instant) -> bool:
        is_changed = False
        for signal in signals:
            before = self._in_force[signal]
            limit = self._deciding(self._limits[signal], before)
            if limit is not before:
                self._in_force[signal] = limit
                self._health.set_limit(signal, limit, now)
                is_changed = True
        return is_changed

    def _deciding(
        self, limits: tuple[ModeLimit, ...], before: ModeLimit | None
    ) -> ModeLimit | None:
        """Return the first limit that applies; where that is not known, the one before."""
        for limit in limits:
            if limit.part is None:
                continue
            actual = self._parts.inference.actual(limit.part)
            if actual.state is LifecycleState.UNKNOWN:
                return before
            if actual.mode == limit.mode:
                return limit
        return _default(limits)


def _default(limits: tuple[ModeLimit, ...]) -> ModeLimit | None:
    return next((limit for limit in limits if limit.part is None), None)
