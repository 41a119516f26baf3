"""The rules for the state of a system, written down straight, to compare the counted ones with."""

from collections.abc import Mapping

from domain.lifecycle import LifecycleState
from domain.parts.system_model import SystemModel
from domain.snapshot import Actual
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

_REST = (LifecycleState.INACTIVE, LifecycleState.UNCONFIGURED)
_ON_THE_WAY = {
    LifecycleState.UNCONFIGURED: LifecycleState.CLEANING_UP,
    LifecycleState.FINALIZED: LifecycleState.SHUTTING_DOWN,
}


class _Undecided(Exception):  # noqa: N818  # an answer, and no error
    """A part that is unknown, or that errs, decides."""

    def __init__(self, answer: Actual) -> None:
        self.answer = answer


def inferred(
    system: SystemModel,
    target: StateAndMode | None,
    actuals: Mapping[PartName, Actual],
    plain: frozenset[PartName],
) -> Actual:
    """Return the state of a system.

    Args:
        system: From the model.
        target: The one in force.
        actuals: Of its parts.
        plain: Nodes without a lifecycle.
    """
    try:
        return _rule(system, target, actuals, plain)
    except _Undecided as undecided:
        return undecided.answer


def _rule(
    system: SystemModel,
    target: StateAndMode | None,
    actuals: Mapping[PartName, Actual],
    plain: frozenset[PartName],
) -> Actual:
    parts = sorted(system.parts, key=str.encode)
    deciding = [p for p in parts if p not in plain or actuals[p].state is LifecycleState.UNKNOWN]
    if target is None:
        return _common(deciding or parts, actuals)
    if target.state is LifecycleState.ACTIVE:
        return _active(system, target.mode, actuals)
    if target.state is LifecycleState.INACTIVE:
        for part in deciding:
            if _known(part, actuals) not in _REST:
                return Actual(LifecycleState.DEACTIVATING, inferred=True)
        return Actual(LifecycleState.INACTIVE, inferred=True)
    if target.state not in _ON_THE_WAY:
        return _undecidable(f"{target.state} cannot be the target of a system")
    states = [_known(part, actuals) for part in deciding]
    arrived = all(state is target.state for state in states)
    return Actual(target.state if arrived else _ON_THE_WAY[target.state], inferred=True)


def _known(part: PartName, actuals: Mapping[PartName, Actual]) -> LifecycleState:
    actual = actuals[part]
    if actual.state is LifecycleState.UNKNOWN:
        reason = actual.reason or f"{part} is unknown"
        raise _Undecided(_undecidable(reason))
    if actual.state is LifecycleState.ERROR_PROCESSING:
        raise _Undecided(Actual(actual.state, inferred=True))
    return actual.state


def _undecidable(reason: str) -> Actual:
    return Actual(LifecycleState.UNKNOWN, inferred=True, undecidable=True, reason=reason)


def _common(parts: list[PartName], actuals: Mapping[PartName, Actual]) -> Actual:
    if not parts:
        return Actual(LifecycleState.UNKNOWN, inferred=True)
    first = _known(parts[0], actuals)
    for part in parts:
        state = _known(part, actuals)
        if state is not first:
            told = f"{parts[0]} is {first} while {part} is {state}"
            return _undecidable(f"there is no target, and {told}")
    return Actual(first, inferred=True)


def _active(
    system: SystemModel, target: ModeName | None, actuals: Mapping[PartName, Actual]
) -> Actual:
    wanted = system.modes.get(target) if target is not None else None
    if wanted is not None:
        states = {part: _known(part, actuals) for part in sorted(wanted, key=str.encode)}
        if all(
            _is(actuals[part], pair)
            or (
                pair.state is LifecycleState.INACTIVE
                and states[part] is LifecycleState.UNCONFIGURED
            )
            for part, pair in wanted.items()
        ):
            return Actual(LifecycleState.ACTIVE, target, inferred=True, mode_inferred=True)
    for part in sorted(system.parts, key=str.encode):
        _known(part, actuals)
    default = system.modes.get(DEFAULT_MODE, {})
    for mode in sorted(system.modes, key=str.encode):
        pairs = system.modes[mode]
        if all(_is(actuals[part], pairs[part]) for part in pairs if part in default):
            return Actual(LifecycleState.ACTIVATING, mode, inferred=True, mode_inferred=True)
    return Actual(LifecycleState.ACTIVATING, inferred=True)


def _is(actual: Actual, pair: StateAndMode) -> bool:
    is_active = pair.state is LifecycleState.ACTIVE
    return actual.state is pair.state and (not is_active or actual.mode == pair.mode)
