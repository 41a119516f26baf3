"""The state of one system, inferred from its parts and kept up to date part by part.

What the rules need is counted: which parts are in which state, and how many parts each mode still
misses. So the work per change of one part depends on the number of modes, and not on the number of
parts: a system may have ten thousand of them.
"""

from bisect import bisect_left, insort
from collections.abc import Callable
from dataclasses import dataclass

from domain.lifecycle import LifecycleState
from domain.parts.system_model import SystemModel
from domain.snapshot import Actual
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

_AT_REST = (LifecycleState.INACTIVE, LifecycleState.UNCONFIGURED)
_ON_THE_WAY = {
    LifecycleState.UNCONFIGURED: LifecycleState.CLEANING_UP,
    LifecycleState.FINALIZED: LifecycleState.SHUTTING_DOWN,
}
_ERROR = Actual(LifecycleState.ERROR_PROCESSING, inferred=True)
_ACTIVATING = Actual(LifecycleState.ACTIVATING, inferred=True)
_DEACTIVATING = Actual(LifecycleState.DEACTIVATING, inferred=True)
_HALTING = (LifecycleState.UNKNOWN, LifecycleState.ERROR_PROCESSING)
"""States of a part that decide about its system at once."""
_UNKNOWN = Actual(LifecycleState.UNKNOWN)


def by_bytes(name: str) -> bytes:
    """Return the key by which parts and modes are ordered."""
    return name.encode()


@dataclass(slots=True)
class _Mode:
    """What one mode requires, and how many parts miss it."""

    name: ModeName
    parts: frozenset[int]
    """Numbers of the parts that it names."""
    active: Actual
    """What a system in this mode is; one object, as below, so that it is told apart at once."""
    activating: Actual
    """What a system is on its way to a mode, while its parts match this one."""
    missing: int = 0
    """Parts that keep a system with this target from being active."""
    unmatched: int = 0
    """Parts of `__DEFAULT__` that are not exactly in what this mode requires."""


@dataclass(frozen=True, slots=True)
class _Line:
    """What one mode requires of one part."""

    mode: _Mode
    state: LifecycleState
    wanted: ModeName | None
    in_default: bool
    """Whether the part is one of `__DEFAULT__`."""

    def count(self, actual: Actual, by: int) -> None:
        """Add `by` to what is missing, if a part in `actual` misses this line.

        A part matches if it is in exactly this state and, if active, in this mode.
        """
        state = actual.state
        if state is self.state and (
            state is not LifecycleState.ACTIVE or actual.mode == self.wanted
        ):
            return
        if self.in_default:
            self.mode.unmatched += by
        # A part that shall be inactive may as well not be configured yet.
        at_rest = state is LifecycleState.UNCONFIGURED
        if not (at_rest and self.state is LifecycleState.INACTIVE):
            self.mode.missing += by


class SystemInference:
    """One system. Parts and modes are ordered by the bytes of their names, as in system_modes."""

    def __init__(self, system: SystemModel) -> None:
        """Begin with parts about which nothing is known.

        Args:
            system: From the model.
        """
        self._names = tuple(sorted(system.named_parts, key=by_bytes))
        self._number = {name: number for number, name in enumerate(self._names)}
        default = system.modes.get(DEFAULT_MODE, {})
        self._in_default = tuple(name in default for name in self._names)
        self._actual = [_UNKNOWN] * len(self._names)
        self._deciding = list(self._in_default)
        """Of each part: whether it decides if the system is at rest; a known plain node is always
        active, and would keep its system from ever being at rest."""
        self._in_state: dict[LifecycleState, list[int]] = {}
        """Numbers of the deciding parts by state, in order."""
        self._halting: list[int] = []
        """Numbers of all named parts in a state of `_HALTING`, in order."""
        self._lines: list[list[_Line]] = [[] for _ in self._names]
        self._modes: dict[ModeName, _Mode] = {}
        for name in sorted(system.modes, key=by_bytes):
            wanted = system.modes[name]
            named = frozenset(self._number[part] for part in wanted)
            active, activating = LifecycleState.ACTIVE, LifecycleState.ACTIVATING
            mode = _Mode(name, named, _in(active, name), _in(activating, name))
            self._modes[name] = mode
            for part, pair in wanted.items():
                line = _Line(mode, pair.state, pair.mode, part in default)
                self._lines[self._number[part]].append(line)
        for number in range(len(self._names)):
            self._add(number)

    def note(self, part: PartName, actual: Actual, *, plain: bool) -> None:
        """Take over the state of a part.

        Args:
            part: One that a mode of the system names.
            actual: Its state and mode.
            plain: Whether it is a node without a lifecycle.
        """
        number = self._number[part]
        self._remove(number)
        self._actual[number] = actual
        known = actual.state is not LifecycleState.UNKNOWN
        self._deciding[number] = self._in_default[number] and not (plain and known)
        self._add(number)

    def infer(self, target: StateAndMode | None) -> Actual:
        """Return the state of the system, by the rule for its target."""
        if target is None:
            return self._common_state()
        if target.state is LifecycleState.ACTIVE:
            return self._towards_active(target.mode)
        if target.state is LifecycleState.INACTIVE:
            return self._towards_inactive()
        if target.state in _ON_THE_WAY:
            return self._towards_rest(target.state)
        return _undecidable(f"{target.state} cannot be the target of a system")

    # --- what is counted -------------------------------------------------------------------------

    def _add(self, number: int) -> None:
        actual = self._actual[number]
        if self._deciding[number]:
            insort(self._in_state.setdefault(actual.state, []), number)
        if actual.state in _HALTING:
            insort(self._halting, number)
        for line in self._lines[number]:
            line.count(actual, 1)

    def _remove(self, number: int) -> None:
        actual = self._actual[number]
        if self._deciding[number]:
            _take_out(self._in_state[actual.state], number)
        if actual.state in _HALTING:
            _take_out(self._halting, number)
        for line in self._lines[number]:
            line.count(actual, -1)

    def _first_deciding(self, is_meant: Callable[[LifecycleState], bool]) -> int | None:
        """Return the first deciding part in one of the states that are meant; None: none is."""
        first = (ns[0] for state, ns in self._in_state.items() if ns and is_meant(state))
        return min(first, default=None)

    # --- rules -----------------------------------------------------------------------------------

    def _halted(self, number: int) -> Actual:
        """Return what follows from a part in a state of `_HALTING`."""
        actual = self._actual[number]
        if actual.state is LifecycleState.ERROR_PROCESSING:
            return _ERROR
        return _undecidable(actual.reason or f"{self._names[number]} is unknown")

    def _common_state(self) -> Actual:
        """Without a target: the state that all parts have in common, without a mode."""
        first = self._first_deciding(lambda _: True)
        if first is None:
            # Plain nodes only, or no parts at all.
            any_part = any(self._in_default)
            state = LifecycleState.ACTIVE if any_part else LifecycleState.UNKNOWN
            return Actual(state, inferred=True)
        common = self._actual[first].state
        if common in _HALTING:
            return self._halted(first)
        other = self._first_deciding(lambda state: state is not common)
        if other is None:
            return Actual(common, inferred=True)
        state = self._actual[other].state
        if state in _HALTING:
            return self._halted(other)
        told = f"{self._names[first]} is {common} while {self._names[other]} is {state}"
        return _undecidable(f"there is no target, and {told}")

    def _towards_inactive(self) -> Actual:
        moving = self._first_deciding(lambda state: state not in _AT_REST)
        if moving is None:
            return Actual(LifecycleState.INACTIVE, inferred=True)
        halted = self._actual[moving].state in _HALTING
        return self._halted(moving) if halted else _DEACTIVATING

    def _towards_rest(self, goal: LifecycleState) -> Actual:
        """Towards `unconfigured` or `finalized`: reached when all parts have reached it."""
        halting = self._first_deciding(_HALTING.__contains__)
        if halting is not None:
            return self._halted(halting)
        arrived = self._first_deciding(lambda state: state is not goal) is None
        return Actual(goal if arrived else _ON_THE_WAY[goal], inferred=True)

    def _towards_active(self, target: ModeName | None) -> Actual:
        """Active once all parts satisfy the target mode; until then activating.

        While activating, the mode is the one that all parts match at the moment, if any.
        """
        wanted = self._modes.get(target) if target is not None else None
        if wanted is not None:
            halting = self._first_halting(wanted.parts.__contains__)
            if halting is not None:
                return self._halted(halting)
            if not wanted.missing:
                return wanted.active
        halting = self._first_halting(self._in_default.__getitem__)
        if halting is not None:
            return self._halted(halting)
        for mode in self._modes.values():
            if not mode.unmatched:
                return mode.activating
        return _ACTIVATING

    def _first_halting(self, is_meant: Callable[[int], bool]) -> int | None:
        return next(filter(is_meant, self._halting), None) if self._halting else None


def _in(state: LifecycleState, mode: ModeName) -> Actual:
    return Actual(state, mode, inferred=True, mode_inferred=True)


def _undecidable(reason: str) -> Actual:
    return Actual(LifecycleState.UNKNOWN, inferred=True, undecidable=True, reason=reason)


def _take_out(ordered: list[int], number: int) -> None:
    del ordered[bisect_left(ordered, number)]
