"""The tree of errors; `api/http/problems.py` maps each class to an HTTP status.

    PilothouseError
    +-- UnknownNameError              a part, mode, signal, error or change that does not exist
    |   +-- UnknownPartError
    |   +-- UnknownModeError
    |   +-- UnknownSignalError
    |   +-- UnknownCheckpointError
    |   +-- UnknownErrorNameError
    |   +-- UnknownReactionError
    |   +-- UnknownChangeError
    |   +-- UnknownParameterError
    |   +-- UnknownTaskError
    |   +-- UnknownEventError
    |   +-- UnknownControllerError
    |   +-- UnknownDeviceError
    |   +-- UnknownProcessError
    +-- InvalidValueError             a value that is never valid: type, range, NaN
    |   +-- FarStartError             a path that begins too far from the vehicle
    +-- InvalidModelError             a model file with findings
    +-- RefusedError                  valid, but rejected in the current situation
    |   +-- IllegalTransitionError
    |   +-- BlockedError
    |   +-- OutdatedReadingError
    |   +-- NotReportedError
    |   +-- ReservedHoldError
    |   +-- TooManyHoldsError
    |   +-- OwnedBySupervisorError
    |   +-- OfflineError
    |   +-- ActsElsewhereError
    |   +-- ProcessElsewhereError
    +-- BackendUnavailableError       the backend is down: no node can be reached
    +-- StorageDegradedError          storage cannot be written, or not be read

Other modules add errors below the same root: conditions (`conditions/lexer.py`) and files
(`service/files/`) that cannot be read, a worker that is busy (`service/worker.py`), malformed
bodies (`api/http/body_parsing.py`). A rejected input changes nothing.
"""

from collections.abc import Sequence
from difflib import get_close_matches

from domain.findings import Blocker, Finding
from domain.lifecycle import LifecycleState, Transition

_LONGEST_COMPARED = 64
_MOST_COMPARED = 200
MAX_NAMED = 5
"""Blockers that a message names; a large robot may have a thousand, and `blockers` lists them."""
MAX_SHOWN = 200
"""Characters of what somebody sent that a message repeats, so that answers stay short."""


def shortened(text: str, most: int = MAX_SHOWN) -> str:
    """Return a text that somebody sent as messages show it: cut if it is longer than `most`."""
    return text if len(text) <= most else f"{text[:most]}..."


class PilothouseError(Exception):
    """Anything that Pilothouse rejects or fails to do; `code` is stable."""

    code = "INTERNAL"
    hint: str | None = None

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.message = message


def near_match(name: str, known: Sequence[str]) -> str | None:
    """Return the known name that is most like a name; None: none is.

    The work is bounded: a long name is like none, and only the first names are looked at.
    """
    if len(name) > _LONGEST_COMPARED:
        return None
    short = [other for other in known[:_MOST_COMPARED] if len(other) <= _LONGEST_COMPARED]
    return next(iter(get_close_matches(name, short, n=1)), None)


class UnknownNameError(PilothouseError):
    """An unknown name.

    Args:
        what: Kind of the name, such as `part`, for the message.
        name: The name that was given.
        known: Valid names for the hint; the first 20 are listed.
        hint: Replaces the list of valid names.
    """

    code = "UNKNOWN_NAME"

    def __init__(self, what: str, name: str, known: Sequence[str], hint: str | None = None) -> None:
        super().__init__(f"there is no {what} {shortened(name)!r}")
        self.name = name
        if hint is not None:
            self.hint = hint
        elif known:
            near = near_match(name, known) if len(known) > 1 else None
            self.hint = f"known: {', '.join(known[:20])}" + (", ..." if len(known) > 20 else "")
            self.hint += "" if near is None else f"; did you mean {near}?"


class UnknownPartError(UnknownNameError):
    """An unknown part: the model has no system or node of this name."""

    code = "UNKNOWN_PART"

    @classmethod
    def of_other_kind(cls, name: str, asked: str, hint: str | None = None) -> "UnknownPartError":
        """Return the error for a system where a node is needed, or the other way round.

        Args:
            name: Of the part.
            asked: `system` or `node`, the kind that is needed.
            hint: What to do.
        """
        error = cls(asked, name, (), hint)
        other = "system" if asked == "node" else "node"
        error.message = f"{shortened(name)!r} is a {other}, not a {asked}"
        error.args = (error.message,)
        return error


class UnknownModeError(UnknownNameError):
    """An unknown mode: the part has no mode of this name."""

    code = "UNKNOWN_MODE"


class UnknownSignalError(UnknownNameError):
    """An unknown signal: it is not declared."""

    code = "UNKNOWN_SIGNAL"


class UnknownCheckpointError(UnknownNameError):
    """An unknown checkpoint: the robot file has none of this name for the node."""

    code = "UNKNOWN_CHECKPOINT"


class UnknownErrorNameError(UnknownNameError):
    """An unknown error name."""

    code = "UNKNOWN_ERROR"


class UnknownReactionError(UnknownNameError):
    """An unknown reaction: the part has none of this name."""

    code = "UNKNOWN_REACTION"


class UnknownChangeError(UnknownNameError):
    """An unknown change: it never existed, or it is too old to be kept."""

    code = "UNKNOWN_CHANGE"


class UnknownParameterError(UnknownNameError):
    """An unknown parameter: the node has none of this name."""

    code = "UNKNOWN_PARAMETER"


class UnknownTaskError(UnknownNameError):
    """An unknown task: it was never submitted, or it is too old to be kept."""

    code = "UNKNOWN_TASK"


class UnknownEventError(UnknownNameError):
    """An unknown event: it never happened, or it is too old to be kept."""

    code = "UNKNOWN_EVENT"


class UnknownControllerError(UnknownNameError):
    """An unknown path tracker."""

    code = "UNKNOWN_CONTROLLER"


class UnknownDeviceError(UnknownNameError):
    """An unknown device: the robot file has none of this name."""

    code = "UNKNOWN_DEVICE"


class UnknownProcessError(UnknownNameError):
    """A node without a process: the robot file has none of it, or another computer runs it."""

    code = "UNKNOWN_PROCESS"

    def __init__(self, node: str, known: Sequence[str]) -> None:
        super().__init__("process of", node, known)
        self.message = f"the robot file has no process of {node} on this computer"
        self.args = (self.message,)


class InvalidValueError(PilothouseError):
    """A value of the wrong type, out of range or not finite; `pointer` names it in a body."""

    code = "INVALID_VALUE"

    def __init__(self, message: str, pointer: str = "") -> None:
        super().__init__(message)
        self.pointer = pointer


class FarStartError(InvalidValueError):
    """A path that begins too far from the vehicle."""

    code = "FAR_START"

    def __init__(
        self, distance_m: float, limit_m: float, nearest: tuple[int, float] | None = None
    ) -> None:
        """State the distance, and a waypoint that is near enough.

        Args:
            distance_m: From the vehicle to the start of the path, in m.
            limit_m: Largest distance allowed, in m.
            nearest: Index of the waypoint nearest to the vehicle, and its distance in m; None: it
                is too far away as well.
        """
        message = f"the path begins {distance_m:.1f} m from the vehicle; at most {limit_m:g} m"
        super().__init__(message, "waypoints")
        self.nearest = nearest
        self.hint = "drive closer, or start at another waypoint with start_index"
        if nearest is not None:
            index, away_m = nearest
            self.hint = f"waypoint {index} is {away_m:.1f} m away: start there with start_index"


class InvalidModelError(PilothouseError):
    """An invalid model; `findings` hold all errors at once."""

    code = "INVALID_MODEL"

    def __init__(self, findings: Sequence[Finding]) -> None:
        errors = [finding for finding in findings if finding.severity == "error"]
        more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
        super().__init__(f"the model is invalid: {errors[0].message if errors else ''}{more}")
        self.findings = tuple(findings)


class RefusedError(PilothouseError):
    """A request that is rejected in the current situation; it may be accepted later."""

    code = "REFUSED"


class IllegalTransitionError(RefusedError):
    """A transition that is illegal in the current state of the part."""

    code = "ILLEGAL_TRANSITION"

    def __init__(
        self,
        part: str,
        transition: Transition,
        state: LifecycleState | None,
        available: Sequence[Transition],
    ) -> None:
        """State where the part is, and what is legal there.

        Args:
            part: The requested part.
            transition: The requested transition.
            state: Current state of the part; None: its nodes are in different states.
            available: Transitions that would be accepted.
        """
        where = f"is {state}" if state else "has parts in different states"
        super().__init__(f"{part} {where}: it cannot {transition}")
        self.available = tuple(available)
        self.hint = f"available: {', '.join(available) or 'nothing'}"


class BlockedError(RefusedError):
    """A change that is blocked; `blockers` list the reasons."""

    code = "BLOCKED"

    def __init__(self, part: str, blockers: Sequence[Blocker]) -> None:
        named = "; ".join(blocker.message for blocker in blockers[:MAX_NAMED])
        rest = len(blockers) - MAX_NAMED
        more = f" (and {rest:,} more)" if rest > 0 else ""
        super().__init__(f"{part} cannot be changed: {named}{more}")
        self.blockers = tuple(blockers)


class OutdatedReadingError(RefusedError):
    """A reading that is older than the one held, and no worse than it."""

    code = "OUTDATED_READING"

    def __init__(self, signal: str, behind_s: float) -> None:
        super().__init__(f"a newer reading of {signal} is held; this one is {behind_s:.3f} s older")
        self.hint = "omit the stamp, or correct the sender's clock"


class NotReportedError(RefusedError):
    """A report of an error that is found by other means."""

    code = "NOT_REPORTED"

    def __init__(self, name: str) -> None:
        super().__init__(f"{name} is found by Pilothouse: nobody can report it, or its end")
        self.hint = "declare an error without when and caused_by to report it"


class ReservedHoldError(RefusedError):
    """A hold that only Pilothouse sets."""

    code = "RESERVED_HOLD"

    def __init__(self, owner: str, *, is_released_by_people: bool = False) -> None:
        verbs = "sets" if is_released_by_people else "sets and releases"
        super().__init__(f"only Pilothouse {verbs} the hold {owner!r}")
        other = "use another name, such as operator"
        self.hint = other if is_released_by_people else f"it is released with its cause; {other}"


class TooManyHoldsError(RefusedError):
    """Too many holds."""

    code = "TOO_MANY_HOLDS"

    def __init__(self, limit: int) -> None:
        super().__init__(f"there are {limit} holds already")


class OwnedBySupervisorError(RefusedError):
    """A request at a device that is the supervisor's to make."""

    code = "OWNED_BY_SUPERVISOR"

    def __init__(self, what: str, supervisor_at: str = "") -> None:
        """State what is commanded elsewhere.

        Args:
            what: The requested part, or the vehicle.
            supervisor_at: Where the supervisor is; empty: on the same computer.
        """
        super().__init__(f"{what} is commanded by the supervisor, which is connected")
        where = f" at {supervisor_at}" if supervisor_at else ""
        self.hint = f"request it of the supervisor{where}; stop, hold, deactivate are possible here"


class OfflineError(RefusedError):
    """A request at a device that does not hear its supervisor."""

    code = "OFFLINE"

    def __init__(self, what: str, device: str, reason: str = "") -> None:
        """State why nothing is commanded.

        Args:
            what: The requested part, or the vehicle.
            device: The device.
            reason: Why it is not connected; empty: it never was since its start.
        """
        why = reason or "it was never connected since its start"
        super().__init__(
            f"{what} is commanded by the supervisor, which {device} cannot hear: {why}"
        )
        self.hint = "restore the connection; stop, hold, deactivate are possible here"


class ActsElsewhereError(RefusedError):
    """A reading, a report or a request about a reaction that is a device's own."""

    code = "ACTS_ELSEWHERE"

    def __init__(self, what: str, device: str, hint: str) -> None:
        """State where it is decided.

        Args:
            what: The reaction, signal or error, and what is done with it on the device.
            device: The device.
            hint: How to ask there.
        """
        super().__init__(f"{what} on device {device}, whatever is said here")
        self.hint = hint

    @classmethod
    def of_reaction(cls, reaction: str, device: str) -> "ActsElsewhereError":
        """Return the error for a request about a reaction."""
        hint = f"arm or acknowledge it on the page of {device}"
        return cls(f"reaction {reaction} acts", device, hint)

    @classmethod
    def of_signal(cls, signal: str, device: str) -> "ActsElsewhereError":
        """Return the error for a reading that did not come from the device."""
        return cls(f"{signal} is read", device, f"post it at {device}")

    @classmethod
    def of_error(cls, error: str, device: str) -> "ActsElsewhereError":
        """Return the error for a report that did not come from the device."""
        return cls(f"{error} is reported", device, f"report it at {device}")


class ProcessElsewhereError(RefusedError):
    """A request about a process where nothing runs processes."""

    code = "PROCESS_NOT_RUN_HERE"

    def __init__(self, node: str) -> None:
        super().__init__(f"the process of {node} is not run here: the nodes are simulated")


class BackendUnavailableError(PilothouseError):
    """The backend is down: no node can be reached; nothing was changed."""

    code = "BACKEND_UNAVAILABLE"

    def __init__(self, reason: str) -> None:
        super().__init__(f"the nodes cannot be reached: {reason}")


class StorageDegradedError(PilothouseError):
    """Storage fails; what must be on disk first cannot be written, or a log cannot be read."""

    code = "STORAGE_DEGRADED"

    def __init__(self, reason: str) -> None:
        super().__init__(f"nothing was done, since it cannot be stored: {reason}")
        self.reason = reason

    @classmethod
    def while_reading(cls, what: str, reason: str) -> "StorageDegradedError":
        """Return the error for what is on disk, such as `earlier events`, and cannot be read."""
        error = cls(reason)
        error.message = f"{what} cannot be read: {reason}"
        error.args = (error.message,)
        return error
