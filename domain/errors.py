"""What can go wrong, as one tree; `api/http/problems.py` maps each class to an HTTP status.

    PilothouseError
    +-- UnknownNameError              a part, mode, signal, error or change that does not exist
    |   +-- UnknownPartError
    |   +-- UnknownModeError
    |   +-- UnknownSignalError
    |   +-- UnknownErrorNameError
    |   +-- UnknownChangeError
    |   +-- UnknownParameterError
    |   +-- UnknownTaskError
    |   +-- UnknownControllerError
    +-- InvalidValueError             a value that can never be right: type, range, NaN
    |   +-- FarStartError             a path that begins too far from the vehicle
    +-- InvalidModelError             a model file with findings
    +-- RefusedError                  right in itself, but not in this situation
    |   +-- IllegalTransitionError
    |   +-- BlockedError
    |   +-- OutdatedReadingError
    |   +-- ReservedHoldError
    |   +-- TooManyHoldsError
    +-- BackendUnavailableError       nothing that nodes could be reached through

Below the same root, `service` and `api` add what only they can meet: files that cannot be read
(`service/files/`), a worker that is busy (`service/worker.py`), bodies that are malformed
(`api/http/body_parsing.py`). A refused input changes nothing.
"""

from collections.abc import Sequence

from domain.findings import Blocker, Finding
from domain.lifecycle import LifecycleState, Transition


class PilothouseError(Exception):
    """Anything that Pilothouse refuses or fails to do; `code` is stable."""

    code = "INTERNAL"
    hint: str | None = None

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.message = message


class UnknownNameError(PilothouseError):
    """A name that nothing is known under."""

    code = "UNKNOWN_NAME"

    def __init__(self, what: str, name: str, known: Sequence[str], hint: str | None = None) -> None:
        super().__init__(f"there is no {what} {name!r}")
        self.name = name
        if hint is not None:
            self.hint = hint
        elif known:
            self.hint = f"known: {', '.join(known[:20])}" + (", ..." if len(known) > 20 else "")


class UnknownPartError(UnknownNameError):
    """A system or node that the model does not have."""

    code = "UNKNOWN_PART"


class UnknownModeError(UnknownNameError):
    """A mode that the part does not have."""

    code = "UNKNOWN_MODE"


class UnknownSignalError(UnknownNameError):
    """A signal that is not declared."""

    code = "UNKNOWN_SIGNAL"


class UnknownErrorNameError(UnknownNameError):
    """A name of no error."""

    code = "UNKNOWN_ERROR"


class UnknownChangeError(UnknownNameError):
    """A change that was never made, or so long ago that it is forgotten."""

    code = "UNKNOWN_CHANGE"


class UnknownParameterError(UnknownNameError):
    """A parameter that the node does not have."""

    code = "UNKNOWN_PARAMETER"


class UnknownTaskError(UnknownNameError):
    """A task that was never served, or so long ago that it is forgotten."""

    code = "UNKNOWN_TASK"


class UnknownControllerError(UnknownNameError):
    """A name of no path tracker."""

    code = "UNKNOWN_CONTROLLER"


class InvalidValueError(PilothouseError):
    """A value of the wrong type, out of range or not finite; `pointer` names it in a body."""

    code = "INVALID_VALUE"

    def __init__(self, message: str, pointer: str = "") -> None:
        super().__init__(message)
        self.pointer = pointer


class FarStartError(InvalidValueError):
    """A path that begins further from the vehicle than a task may."""

    code = "FAR_START"

    def __init__(
        self, distance_m: float, limit_m: float, nearest: tuple[int, float] | None = None
    ) -> None:
        """Say how far it is.

        Args:
            distance_m: Between the vehicle and where the path would begin.
            limit_m: So far it may be.
            nearest: The waypoint that is nearest to the vehicle, and how far that is, m; None: it
                is too far as well.
        """
        message = f"the path begins {distance_m:.1f} m from the vehicle; at most {limit_m:g} m"
        super().__init__(message, "waypoints")
        self.nearest = nearest
        self.hint = "drive closer, or begin at another waypoint with start_index"
        if nearest is not None:
            index, away_m = nearest
            self.hint = f"waypoint {index} is {away_m:.1f} m away: begin there with start_index"


class InvalidModelError(PilothouseError):
    """A model that cannot be used; `findings` hold all reasons at once."""

    code = "INVALID_MODEL"

    def __init__(self, findings: Sequence[Finding]) -> None:
        errors = [finding for finding in findings if finding.severity == "error"]
        more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
        super().__init__(f"the model is invalid: {errors[0].message if errors else ''}{more}")
        self.findings = tuple(findings)


class RefusedError(PilothouseError):
    """A request that is refused in this situation; the same may be accepted later."""

    code = "REFUSED"


class IllegalTransitionError(RefusedError):
    """A transition that does not exist from where the part is."""

    code = "ILLEGAL_TRANSITION"

    def __init__(
        self,
        part: str,
        transition: Transition,
        state: LifecycleState | None,
        available: Sequence[Transition],
    ) -> None:
        where = f"is {state}" if state else "has parts in different states"
        super().__init__(f"{part} {where}: it cannot {transition}")
        self.available = tuple(available)
        self.hint = f"available: {', '.join(available) or 'nothing'}"


class BlockedError(RefusedError):
    """A change that something stands against; `blockers` say what."""

    code = "BLOCKED"

    def __init__(self, part: str, blockers: Sequence[Blocker]) -> None:
        super().__init__(f"{part} cannot be changed: {'; '.join(b.message for b in blockers)}")
        self.blockers = tuple(blockers)


class OutdatedReadingError(RefusedError):
    """A reading older than one that is already held, and no worse than it."""

    code = "OUTDATED_READING"

    def __init__(self, signal: str, behind_s: float) -> None:
        super().__init__(f"a newer reading of {signal} is held; this one is {behind_s:.3f} s older")
        self.hint = "leave out the stamp, or set the sender's clock"


class ReservedHoldError(RefusedError):
    """A hold that Pilothouse alone sets and clears."""

    code = "RESERVED_HOLD"

    def __init__(self, owner: str) -> None:
        super().__init__(f"the hold {owner!r} is set and cleared by Pilothouse alone")
        self.hint = "it ends with its cause; use a name of your own, such as operator"


class TooManyHoldsError(RefusedError):
    """One more hold than are kept."""

    code = "TOO_MANY_HOLDS"

    def __init__(self, limit: int) -> None:
        super().__init__(f"there are {limit} holds already")


class BackendUnavailableError(PilothouseError):
    """No node can be reached at all; nothing was changed."""

    code = "BACKEND_UNAVAILABLE"

    def __init__(self, reason: str) -> None:
        super().__init__(f"the nodes cannot be reached: {reason}")
