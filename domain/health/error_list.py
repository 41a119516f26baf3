"""All errors, of the robot and of its parts: which are on, since when, and how often."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import chain, islice
from typing import NamedTuple

from domain.events.health import ErrorCleared, ErrorRaised
from domain.findings import Fact
from domain.health.built_in_errors import severity_of
from domain.health.error_causes import MAX_SHOWN, NO_CAUSES, ErrorCauses
from domain.health.on_errors import OnErrors
from domain.health.severe_errors import SevereErrors
from domain.outbox import Outbox
from domain.snapshot import ErrorKey, ErrorState, ErrorView, Severity
from domain.state_and_mode import PartName
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

    def __init__(self, outbox: Outbox, causes: ErrorCauses = NO_CAUSES) -> None:
        """Begin with all errors normal.

        Args:
            outbox: Is told what changed.
            causes: Which errors explain which.
        """
        self._outbox = outbox
        self.causes = causes
        self._severities: dict[ErrorKey, Severity] = {}
        """Of those of signals."""
        self._of_signals: dict[PartName | None, list[str]] = {}
        self._open: dict[ErrorKey, ErrorView] = {}
        """Those that are not normal."""
        self._ended: dict[ErrorKey, ErrorView] = {}
        """Those that are normal, and were raised before."""
        self.on = OnErrors(outbox)
        self.severe = SevereErrors()
        self._told: dict[ErrorKey, int] = {}
        """By error, the newest event that told that it was raised or cleared."""
        self._first: ErrorKey | None = None
        """The error that was raised first since none was on."""

    # --- what happens ----------------------------------------------------------------------------

    def declare(self, key: ErrorKey, severity: Severity) -> None:
        """Give an error of a signal a severity of its own."""
        self._severities[key] = severity
        self._of_signals.setdefault(key.part, []).append(key.error)

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
            known.caused_by if known is not None and was_on and found.state.is_on else (),
            known.roots if known is not None and was_on and found.state.is_on else (),
            self._hint_of(key),
        )
        self._put(view)
        if found.state.is_on is not was_on:
            self._switch(key, on=raised)

    def raise_(self, key: ErrorKey, found: Found, since: Instant, cause: int | None = None) -> None:
        """Raise an error of a part, and tell it; of one that is on, note what is found now.

        Args:
            key: The error.
            found: What was found.
            since: When it was raised.
            cause: Id of the event that led to it; None: the current input.
        """
        was_on = self.is_on(key)
        self.note(key, found, since)
        if not was_on:
            self.tell_raised(key, cause)

    def tell_raised(self, key: ErrorKey, cause: int | None = None) -> None:
        """Tell that an error of a part is on."""
        view = self._open[key]
        raised = ErrorRaised(
            key.error, view.message, view.value, view.threshold, key.part, view.is_root
        )
        self._tell(key, self._outbox.emit(raised, cause))

    def clear(self, key: ErrorKey, cause: int | None = None) -> None:
        """Note that the cause of an error of a part is gone, and tell it if the error ended.

        Args:
            key: The error.
            cause: Id of the event that led to it; None: the current input.
        """
        before = self.view(key)
        self.note(key, NORMAL, 0)
        if before.state.is_on and not self.is_on(key):
            cleared = ErrorCleared(key.error, key.part, before.is_root)
            self._tell(key, self._outbox.emit(cleared, cause))

    def forget(self, key: ErrorKey) -> None:
        """Forget an error that is on as if it had never been raised."""
        del self._open[key]
        self._outbox.errors.add(key)
        self._put_severe(self.view(key))
        self._switch(key, on=False)

    def renew_roots(self, key: ErrorKey) -> bool:
        """Find the roots of an error that is on anew; return whether they changed.

        While none of its causes is on, it keeps those that it had.
        """
        if key not in self.on:
            return False
        causes = self.causes.present(key, self.on.parts_by_name, self.is_on)
        if not causes:
            return False
        found = (self._open[cause].roots or (cause,) for cause in causes)
        roots = tuple(islice(dict.fromkeys(chain.from_iterable(found)), MAX_SHOWN))
        view = self._open[key]
        if (causes, roots) == (view.caused_by, view.roots):
            return False
        self._put(replace(view, caused_by=causes, roots=roots))
        if key in self.on.contenders and self._first in self.on.contenders:
            self._mark_first(min(self.on.contenders, key=self._rank))
        return True

    # --- what can be seen ------------------------------------------------------------------------

    def is_on(self, key: ErrorKey) -> bool:
        """Tell whether an error is on."""
        view = self._open.get(key)
        return view is not None and view.state.is_on

    def names_of(self, part: PartName | None) -> Iterable[str]:
        """Return all errors of a part, those of signals last; None: of the robot itself."""
        if part is not None:
            yield from self.causes.names_of(part)
        yield from dict.fromkeys(self._of_signals.get(part, ()))

    def view(self, key: ErrorKey) -> ErrorView:
        """Return an error; the same object until it changes, unless it was never raised."""
        known = self._open.get(key) or self._ended.get(key)
        if known is not None:
            return known
        severity = self._severity_of(key)
        hint = self._hint_of(key)
        return ErrorView(
            key, severity, ErrorState.NORMAL, False, "", None, None, None, 0, hint=hint
        )

    def told_by(self, key: ErrorKey) -> int | None:
        """Return the newest event that told of an error of a part; None: there is none."""
        return self._told.get(key)

    def open_ones(self) -> Mapping[str, ErrorView]:
        """Return the errors that are not normal, by their names."""
        return {key.name: view for key, view in self._open.items()}

    @property
    def parts_with(self) -> Mapping[str, int]:
        """Return by error how many parts have it now."""
        return {error: len(parts) for error, parts in self.on.parts_by_name.items()}

    # --- inside ----------------------------------------------------------------------------------

    def _tell(self, key: ErrorKey, event: int) -> None:
        self._told[key] = event
        if self._severity_of(key).stops_task:
            self.severe.decided_by = event

    def _severity_of(self, key: ErrorKey) -> Severity:
        declared = self.causes.declared.get(key)
        if declared is not None and declared.severity is not None:
            return declared.severity
        return self._severities.get(key) or severity_of(key)

    def _hint_of(self, key: ErrorKey) -> str:
        declared = self.causes.declared.get(key)
        return "" if declared is None else declared.hint

    def _put(self, view: ErrorView) -> None:
        is_open = view.state is not ErrorState.NORMAL
        here, there = (self._open, self._ended) if is_open else (self._ended, self._open)
        there.pop(view.key, None)
        if is_open or view.count:
            here[view.key] = view
        self._outbox.errors.add(view.key)
        self._put_severe(view)

    def _put_severe(self, view: ErrorView) -> None:
        """Signals set the bits of their errors themselves, and declare each of them."""
        if view.key.part is not None and view.key not in self._severities:
            self.severe.put(view)

    def _switch(self, key: ErrorKey, *, on: bool) -> None:
        """Note that an error was raised or ended; find its roots, and which was first."""
        was_empty = self.on.is_empty
        self.on.switch(key, on=on)
        if on:
            is_first = was_empty or (
                self._first in self.on.contenders
                and key in self.on.contenders
                and self._rank(key) < self._rank(self._first)
            )
            if is_first:
                self._mark_first(key)
            self.renew_roots(key)
        elif self.on.is_empty:
            self._mark_first(None)

    def _rank(self, key: ErrorKey | None) -> tuple[bool, int, int]:
        """Return where an error stands in its step: roots first, then as in the file."""
        if key is None:
            return (True, 0, 0)
        _, part, position = self.causes.place(key)
        return (not self.view(key).is_root, part, position)

    def _mark_first(self, key: ErrorKey | None) -> None:
        for changed, is_first in ((self._first, False), (key, True)):
            known = None if changed is None else self._open.get(changed) or self._ended.get(changed)
            if known is not None:
                self._put(replace(known, first_out=is_first))
        self._first = key
