"""All errors, of the robot and of its parts: which are on, since when, and how often."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from domain.findings import Fact
from domain.health.alarm import QUIET, Alarm, Evidence
from domain.health.alarms import Alarms
from domain.health.built_in_errors import severity_of
from domain.health.turns import Turn
from domain.kept import KeptUnacknowledged
from domain.outbox import Outbox
from domain.snapshot import NO_MARKS, ErrorKey, ErrorMarks, ErrorState, ErrorView, Severity
from domain.timebase import Instant


class Found(NamedTuple):
    """What was found of an error; whether somebody has seen it is added here."""

    state: ErrorState
    """`normal`, `pending`, `active`, or `latched`: who found it keeps it on until it is
    acknowledged."""
    message: str = ""
    value: Fact = None
    threshold: Fact = None
    lingers: bool = False
    """It is active for its minimum time only: its cause is gone."""


NORMAL = Found(ErrorState.NORMAL)


class ErrorList:
    """What is known of each error; whoever decides about an error notes it here.

    An error that was never raised takes no memory: a robot may have ten thousand parts.
    """

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._alarms = Alarms(outbox)
        self._severities: dict[ErrorKey, Severity] = {}
        """Of those that are declared."""
        self._latching: set[ErrorKey] = set()
        """Those that stay on until they are acknowledged; signals keep their own on."""
        self._open: dict[ErrorKey, ErrorView] = {}
        """Those that are not normal, or shelved."""
        self._ended: dict[ErrorKey, ErrorView] = {}
        """The others of which something is to be said: they were raised before, for example."""
        self._turns: list[Turn] = []
        self._parts_with: dict[str, int] = {}
        """By error, how many parts have it."""
        self._count_on = 0
        self._first: ErrorKey | None = None
        """The error that was raised first since none was on."""

    # --- what happens ----------------------------------------------------------------------------

    def declare(
        self, key: ErrorKey, severity: Severity | None = None, *, latches: bool = False
    ) -> None:
        """Give an error settings of its own.

        Args:
            key: The error.
            severity: None: that of the built-in error.
            latches: It stays on after its cause until it is acknowledged; signals keep their own
                errors on by themselves.
        """
        if severity is not None:
            self._severities[key] = severity
        if latches:
            self._latching.add(key)

    def note(self, key: ErrorKey, found: Found, since: Instant) -> None:
        """Note what was found of an error; of several, in the order of the file.

        Args:
            key: The error.
            found: What was found.
            since: When it was raised, or began to be pending; it stays as it was noted first.
        """
        before = self._alarms[key]
        evidence = Evidence(found.state, found.lingers)
        after = before.after(evidence, since, self._outbox.now, latches=key in self._latching)
        if self._alarms.is_from_start(key) and not after.state.is_on:
            after = Alarm(evidence)
        known = self.view(key)
        told = (known.message, known.value, known.threshold)
        if after == before and (after == QUIET or told == (found[1:4])):
            return
        self._show(known, before, after, found, since)

    def forget(self, key: ErrorKey) -> None:
        """Forget an error that is on since the start, as if it had never been raised."""
        if not self._alarms.is_from_start(key):
            # An earlier run raised it, and nobody saw that.
            self.note(key, NORMAL, 0)
            return
        self._alarms.discard(key)
        del self._open[key]
        self._outbox.errors.add(key)
        self._count(key, -1)

    def mark_start(self) -> None:
        """Take what is on now as how each robot begins: its end leaves nothing to see."""
        self._alarms.mark_start()
        self._turns.clear()

    def acknowledge(self, key: ErrorKey) -> bool:
        """Note that somebody has seen an error; return whether that changed anything.

        An error that was on for want of that ends.
        """
        before = self._alarms[key]
        after = before.acknowledged()
        if after == before:
            return False
        known = self.view(key)
        found = Found(after.found.state, known.message, known.value, known.threshold)
        self._show(known, before, after, found, known.since or 0)
        return True

    def restore(self, kept: KeptUnacknowledged, now: Instant) -> None:
        """Bring back that nobody acknowledged an error of an earlier run.

        It stays on if it has to be acknowledged, and has returned otherwise. If its cause is
        present already, it stays as it is.
        """
        key = ErrorKey(kept.part, kept.error)
        self._alarms.restore(kept)
        if self.is_on(key):
            return
        state = ErrorState.LATCHED if key in self._latching else ErrorState.NORMAL
        since = min(kept.since, now)
        alarm = Alarm(Evidence(state), unseen=True, raised=since)
        found = Found(state, kept.message, kept.value, kept.threshold)
        self._show(self.view(key), QUIET, alarm, found, since)

    def mark(self, key: ErrorKey, marks: ErrorMarks) -> None:
        """Note what silences an error, or that it chatters; its state stays."""
        known = self.view(key)
        if known.marks != marks:
            self._put(replace(known, marks=marks))

    def take_turns(self) -> list[Turn]:
        """Return what was raised or ended since the last call, in order."""
        taken, self._turns = self._turns, []
        return taken

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
        """Return the errors that are not normal, or shelved, by their names."""
        return {key.name: view for key, view in self._open.items()}

    @property
    def parts_with(self) -> Mapping[str, int]:
        """Return by error how many parts have it now; read only."""
        return self._parts_with

    # --- inside ----------------------------------------------------------------------------------

    def _severity_of(self, key: ErrorKey) -> Severity:
        return self._severities.get(key) or severity_of(key)

    def _show(
        self, known: ErrorView, before: Alarm, after: Alarm, found: Found, since: Instant
    ) -> None:
        """Show an error as it is announced now.

        Args:
            known: As it was shown.
            before: As it was announced.
            after: As it is announced now.
            found: What was found.
            since: When it was raised, or began to be pending.
        """
        state, was_on = after.state, before.state.is_on
        began: Instant | None = since
        if state is ErrorState.NORMAL:
            found, began = NORMAL, None
        elif state is not ErrorState.PENDING:
            began = after.raised
        elif known.state is ErrorState.PENDING:
            began = known.since
        if not found.message and after.unseen:
            # What nobody has seen stays readable after its end.
            found = Found(found.state, known.message, known.value, known.threshold)
        raised = state.is_on and not was_on
        view = replace(
            known,
            state=state,
            message=found.message,
            value=found.value,
            threshold=found.threshold,
            since=began,
            ended=after.ended,
            count=known.count + raised,
        )
        too_many = self._alarms.put(view, after)
        self._put(view)
        if state.is_on is not was_on:
            self._turns.append(Turn(view.key, raised, self._outbox.now))
            self._count(view.key, 1 if raised else -1)
        if too_many is not None:
            self.acknowledge(too_many)

    def _put(self, view: ErrorView) -> None:
        is_open = view.is_open
        here, there = (self._open, self._ended) if is_open else (self._ended, self._open)
        there.pop(view.key, None)
        if is_open or view.count or view.marks != NO_MARKS:
            here[view.key] = view
        else:
            here.pop(view.key, None)
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
