"""The complaint about a name that there is not, in the words of the service."""

from collections.abc import Sequence

from api.client.outcomes import ServiceProblemError


def no_such(what: str, name: str, known: Sequence[str]) -> ServiceProblemError:
    """Return the error for an unknown name, with the known ones and the nearest of them.

    Args:
        what: Kind of the name, such as `hold`.
        name: That was given.
        known: Valid names.
    """
    from domain.errors import UnknownNameError

    error = UnknownNameError(what, name, known)
    hint = error.hint or f"there is no {what} at all"
    return ServiceProblemError({"detail": error.message, "hint": hint})
