"""All errors, of the robot and of its parts: which are on, since when, and how often."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from domain.findings import Fact
from domain.health.built_in_errors import severity_of
from domain.outbox import Outbox
from domain.snapshot import ErrorKey, ErrorState, ErrorView, Severity
from domain.timebase import Instant


class Found(NamedTuple):
    """What was found of an error."""

    state: ErrorState
    message: str = ""
    value: Fact = None
    threshold: Fact = None


NORMAL = Found(ErrorState.NORMAL)


class ErrorList:
    """What is known of each error; whoever decides about an error notes it here.

    An error that was never raised takes no memory: a robot may have ten thousand parts.
    """

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._severities: dict[ErrorKey, Severity] = {}
        """Of those that are declared."""
        self._open: dict[ErrorKey, ErrorView] = {}
        """Those that are not normal."""
        self._ended: dict[ErrorKey, ErrorView] = {}
        """Those that are normal, and were raised before."""
        self._parts_with: dict[str, int] = {}
        """By error, how many parts have it."""
        self._count_on = 0
        self._first: ErrorKey | None = None
        """The error that was raised first since none was on."""

    # --- what happens ----------------------------------------------------------------------------

    def declare(self, key: ErrorKey, severity: Severity) -> None:
        """Give an error a severity of its own."""
        self._severities[key] = severity

    def note(self, key: ErrorKey, found: Found, since: Instant) -> None:
        """Note what was found of an error; of several, in the order of the file.

        Args:
            key: The error.
            found: What was found.
            since: When it was raised, or began to be pending; it stays as it was noted first.
        """
        known = self._open.get(key) or self._ended.get(key)
        if known is None:
            if found.state is ErrorState.NORMAL:
                return
        elif found == (known.state, known.message, known.value, known.threshold):
            return
        was_on = known is not None and known.state.is_on
        if known is None or was_on is not found.state.is_on or known.state is ErrorState.NORMAL:
            began = since
        else:
            began = since if known.since is None else known.since
        raised = found.state.is_on and not was_on
        view = ErrorView(
            key,
            self._severity_of(key),
            found.state,
            known is not None and known.first_out,
            found.message,
            found.value,
            found.threshold,
            None if found.state is ErrorState.NORMAL else began,
            (0 if known is None else known.count) + raised,
        )
        self._put(view)
        if found.state.is_on is not was_on:
            self._count(key, 1 if raised else -1)

    def forget(self, key: ErrorKey) -> None:
        """Forget an error that is on as if it had never been raised."""
        del self._open[key]
        self._outbox.errors.add(key)
        self._count(key, -1)

    # --- what can be seen ------------------------------------------------------------------------

    def is_on(self, key: ErrorKey) -> bool:
        """Tell whether an error is on."""
        view = self._open.get(key)
        return view is not None and view.state.is_on

    def view(self, key: ErrorKey) -> ErrorView:
        """Return an error; the same object until it changes, unless it was never raised."""
        known = self._open.get(key) or self._ended.get(key)
        if known is not None:
            return known
        severity = self._severity_of(key)
        return ErrorView(key, severity, ErrorState.NORMAL, False, "", None, None, None, 0)

    def open_ones(self) -> Mapping[str, ErrorView]:
        """Return the errors that are not normal, by their names."""
        return {key.name: view for key, view in self._open.items()}

    @property
    def parts_with(self) -> Mapping[str, int]:
        """Return by error how many parts have it now; read only."""
        return self._parts_with

    # --- inside ----------------------------------------------------------------------------------

    def _severity_of(self, key: ErrorKey) -> Severity:
        return self._severities.get(key) or severity_of(key)

    def _put(self, view: ErrorView) -> None:
        is_open = view.state is not ErrorState.NORMAL
        here, there = (self._open, self._ended) if is_open else (self._ended, self._open)
        there.pop(view.key, None)
        if is_open or view.count:
            here[view.key] = view
        self._outbox.errors.add(view.key)

    def _count(self, key: ErrorKey, step: int) -> None:
        """Count an error that was raised or ended, and tell which was first."""
        if key.part is not None:
            self._parts_with[key.error] = self._parts_with.get(key.error, 0) + step
        self._count_on += step
        if step > 0 and self._count_on == 1:
            self._mark_first(key)
        elif self._count_on == 0:
            self._mark_first(None)

    def _mark_first(self, key: ErrorKey | None) -> None:
        for changed, is_first in ((self._first, False), (key, True)):
            known = None if changed is None else self._open.get(changed) or self._ended.get(changed)
            if known is not None:
                self._put(replace(known, first_out=is_first))
        self._first = key
