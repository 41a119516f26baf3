"""How lint says what it found."""

from domain.findings import Finding
from domain.lifecycle import LifecycleState
from domain.state_and_mode import DEFAULT_MODE, StateAndMode


def warning(code: str, message: str, *path: str) -> Finding:
    """Return a warning about the place to which the keys of `path` lead, the part first."""
    return Finding("warning", code, message, path[0], path)


def meaning(pair: StateAndMode) -> StateAndMode:
    """Return one value for pairs that agree: only active has modes, and None is the default."""
    if pair.state is not LifecycleState.ACTIVE:
        return StateAndMode(pair.state)
    return StateAndMode(pair.state, pair.mode or DEFAULT_MODE)
