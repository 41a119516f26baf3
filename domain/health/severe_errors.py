"""The errors of parts that put the robot into ERROR, beside those that signals raise."""

from collections.abc import Callable

from domain.findings import Blocker
from domain.snapshot import ErrorKey, ErrorView

MAX_REASONS = 100
"""Reasons that are shown at once; the names of all errors are."""


class SevereErrors:
    """Keeps the names and the reasons of critical and fatal errors of parts."""

    def __init__(self) -> None:
        self._on: dict[ErrorKey, ErrorView] = {}
        self._names: tuple[str, ...] = ()
        self._reasons: tuple[Blocker, ...] | None = ()
        self.decided_by: int | None = None
        """The newest event that told that one of them was raised or cleared."""

    def put(self, view: ErrorView) -> None:
        """Note how an error of a part is now."""
        key, was_on = view.key, view.key in self._on
        is_on = view.state.is_on and view.severity.stops_task
        if not was_on and not is_on:
            return
        if is_on:
            self._on[key] = view
        else:
            del self._on[key]
        if is_on is not was_on:
            self._names = tuple(each.name for each in self._on)
        self._reasons = None

    @property
    def names(self) -> tuple[str, ...]:
        """Return the names of those that are on, in the order in which they were raised."""
        return self._names

    def reasons(self, view_of: Callable[[ErrorKey], ErrorView]) -> tuple[Blocker, ...]:
        """Return why, the roots first; the same object until it changes.

        Args:
            view_of: Returns an error, which may be a root that is not severe itself.
        """
        if self._reasons is None:
            views = sorted(self._on.values(), key=lambda view: not view.is_root)
            self._reasons = tuple(reason_of(view, view_of) for view in views[:MAX_REASONS])
        return self._reasons


def reason_of(view: ErrorView, view_of: Callable[[ErrorKey], ErrorView]) -> Blocker:
    """Return why an error of a part is on, with the errors that it goes back to.

    Args:
        view: The error.
        view_of: Returns an error.
    """
    roots = (view_of(root) for root in view.roots)
    return Blocker(
        view.key.error,
        view.message,
        () if view.key.part is None else (view.key.part,),
        view.value,
        view.threshold,
        view.since,
        root_cause=view.is_root,
        causes=tuple(
            reason_of(root, view_of) for root in roots if root.state.is_on and root.is_root
        ),
    )
