"""JSON text of an error, the same as that of `ErrorJson`, made in a fraction of its time.

A robot of 10,000 nodes has 50,000 errors.
"""

from collections.abc import Callable

from pydantic_core import to_json

from domain.snapshot import ErrorView
from domain.timebase import Instant


def error_text(view: ErrorView, show: Callable[[Instant], str]) -> str:
    """Return an error as clients see it.

    Args:
        view: Of the error.
        show: Returns an instant as RFC 3339.
    """
    key, since = view.key, view.since
    shown = {
        "error": key.error,
        "part": key.part,
        "severity": str(view.severity),
        "state": str(view.state),
        "shelved_until_at": None,
        "suppressed": False,
        "chattering": False,
        "root_cause": view.is_root,
        "first_out": view.first_out,
        "caused_by": [each._asdict() for each in view.caused_by],
        "roots": [each._asdict() for each in view.roots or (key,)],
        "message": view.message,
        "value": view.value,
        "threshold": view.threshold,
        "since_at": None if since is None else show(since),
        "count": view.count,
        "hint": view.hint or None,
    }
    return to_json(shown, inf_nan_mode="null").decode()
