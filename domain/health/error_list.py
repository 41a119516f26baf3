"""All errors, of the robot and of its parts: which are on, since when, and how often."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import chain, islice
from typing import NamedTuple

from domain.events.health import ErrorCleared, ErrorRaised
from domain.findings import Fact
from domain.health.alarm import QUIET, Alarm, Evidence
from domain.health.alarms import Alarms
from domain.health.error_causes import MAX_SHOWN, NO_CAUSES, ErrorCauses
from domain.health.on_errors import OnErrors
from domain.health.severe_errors import SevereErrors
from domain.health.turns import Turn
from domain.kept import KeptUnacknowledged
from domain.outbox import Outbox
from domain.snapshot import NO_MARKS, ErrorKey, ErrorMarks, ErrorState, ErrorView, Severity
from domain.state_and_mode import PartName
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

    def __init__(self, outbox: Outbox, causes: ErrorCauses = NO_CAUSES) -> None:
        """Begin with all errors normal.

        Args:
            outbox: Is told what changed.
            causes: Which errors explain which.
        """
        self._outbox = outbox
        self.causes = causes
        self._alarms = Alarms(outbox)
        self._severities: dict[ErrorKey, Severity] = {}
        """Of those of signals."""
        self._of_signals: dict[PartName | None, list[str]] = {}
        self._silent: dict[ErrorKey, tuple[ErrorView, Alarm]] = {}
        """Those that are on without a word, and what there was to see of each before."""
        self._latching: set[ErrorKey] = set()
        """Those that stay on until they are acknowledged; signals keep their own on."""
        self._open: dict[ErrorKey, ErrorView] = {}
        """Those that are not normal, or shelved."""
        self._ended: dict[ErrorKey, ErrorView] = {}
        """The others of which something is to be said: they were raised before, for example."""
        self._turns: list[Turn] = []
        self.on = OnErrors(outbox)
        self.severe = SevereErrors()
        self._told: dict[ErrorKey, int] = {}
        """By error, the newest event that told that it was raised or cleared."""
        self._given: dict[ErrorKey, tuple[ErrorKey, ...]] = {}
        """What explains an error by word of who found it."""
        self._first: ErrorKey | None = None
        """The error that was raised first since none was on."""

    # --- what happens ----------------------------------------------------------------------------

    def declare(
        self, key: ErrorKey, severity: Severity | None = None, *, latches: bool = False
    ) -> None:
        """Give an error settings of its own.

        Args:
            key: The error.
            severity: Of an error of a signal; None: it is none, and the model says its severity.
            latches: It stays on after its cause until it is acknowledged; signals keep their own
                errors on by themselves.
        """
        if severity is not None:
            self._severities[key] = severity
            self._of_signals.setdefault(key.part, []).append(key.error)
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
        if not after.state.is_on and self._is_seen_with_roots(known):
            after = Alarm(evidence)
        told = (known.message, known.value, known.threshold)
        if after == before and (after == QUIET or told == (found[1:4])):
            return
        self._show(known, before, after, found, since)

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

    def raise_silently(self, key: ErrorKey, found: Found, since: Instant) -> None:
        """Raise an error that only follows from who was never heard of: that is how a robot begins.

        It is told once it follows from anything else. If it ends before, it leaves no trace, and
        what an earlier run left to be seen of it stays as it was. One that is on is noted only.

        Args:
            key: The error.
            found: What was found.
            since: When it was raised.
        """
        if not self.is_on(key):
            self.note(key, NORMAL, 0)  # It may be pending.
            self._silent[key] = self.view(key), self._alarms[key]
            self._alarms.take_as_start(key)
        self.note(key, found, since)

    def tell_raised(self, key: ErrorKey, cause: int | None = None) -> None:
        """Tell that an error of a part is on."""
        self._silent.pop(key, None)
        self._alarms.note_told(key)
        view = self._open[key]
        raised = ErrorRaised(
            key.error,
            view.message,
            view.value,
            view.threshold,
            key.part,
            view.is_root,
            view.marks.is_silenced,
            of_device=self.causes.is_of_device(key),
        )
        self.note_told(key, self._outbox.emit(raised, cause))

    def clear(self, key: ErrorKey, cause: int | None = None) -> None:
        """Note that the cause of an error of a part is gone, and tell it if the error ended.

        Args:
            key: The error.
            cause: Id of the event that led to it; None: the current input.
        """
        if key in self._silent:
            self.forget(key)
            return
        before = self.view(key)
        self.note(key, NORMAL, 0)
        if before.state.is_on and not self.is_on(key):
            self.tell_cleared(before, cause)

    def tell_cleared(self, before: ErrorView, cause: int | None = None) -> None:
        """Tell that an error of a part is over.

        Args:
            before: As it was.
            cause: Id of the event that led to it; None: the current input.
        """
        key = before.key
        cleared = ErrorCleared(
            key.error,
            key.part,
            before.is_root,
            before.marks.is_silenced,
            of_device=self.causes.is_of_device(key),
        )
        self.note_told(key, self._outbox.emit(cleared, cause))

    def note_told(self, key: ErrorKey, event: int) -> None:
        """Note which event told that an error was raised or cleared."""
        self._told[key] = event
        if self._severity_of(key).stops_task and key.part is not None:
            self.severe.decided_by = event

    def forget(self, key: ErrorKey) -> None:
        """Forget an error that is on since the start, as if it had never been raised."""
        before, alarm = self._silent.pop(key, (None, QUIET))
        if not self._alarms.is_from_start(key):
            # An earlier run raised it, and nobody saw that.
            self.note(key, NORMAL, 0)
            return
        is_seen = not self._alarms[key].unseen
        self._alarms.discard(key)
        marks = self._open.pop(key).marks
        if before is None or (alarm.unseen and is_seen):
            before, alarm = self.view(key), QUIET
        after = replace(before, marks=marks, first_out=False)
        self._put(after)
        self._alarms.put(after, alarm)
        self._switch(key, on=False)
        if key == self._first:
            self._mark_first(self.on.oldest)

    def explain(self, key: ErrorKey, causes: tuple[ErrorKey, ...]) -> None:
        """Note what explains an error this time, beside what always does; until it is over.

        Args:
            key: The error, which is on or about to be raised.
            causes: Other errors; empty: nothing does.
        """
        self._given[key] = causes
        if key in self.on:
            causes, roots = self.explanation_of(key)
            self._put(replace(self._open[key], caused_by=causes, roots=roots))

    def renew_roots(self, key: ErrorKey) -> bool:
        """Find the roots of an error that is on anew; return whether they changed.

        While none of its causes is on, it keeps those that it had, unless they are forgotten.
        """
        if key not in self.on:
            return False
        causes, roots = self.explanation_of(key)
        view = self._open[key]
        if not causes and any(self.view(root).count for root in view.roots):
            return False
        if (causes, roots) == (view.caused_by, view.roots):
            return False
        self._put(replace(view, caused_by=causes, roots=roots))
        if not self._is_kept_as_such(key):
            self._alarms.keep_no_longer(key)
        if key in self.on.contenders and self._first in self.on.contenders:
            self._note_rank(key)
        return True

    def mark_start(self) -> None:
        """Take what is on now as how each robot begins: its end leaves nothing to see."""
        self._alarms.mark_start()
        self._turns.clear()

    def acknowledge(self, key: ErrorKey) -> bool:
        """Note that somebody has seen an error; return whether that changed anything.

        An error that was on for want of that ends. What followed from it and has returned is seen
        with it: it was not announced by itself.
        """
        if not self._see(key):
            return False
        for other in self._alarms.returned:
            view = self.view(other)
            if key in view.roots and self._is_seen_with_roots(view):
                self._see(other)
        return True

    def _see(self, key: ErrorKey) -> bool:
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

    def is_silent(self, key: ErrorKey) -> bool:
        """Tell whether an error is on without a word."""
        return key in self._silent

    def is_of_signal(self, key: ErrorKey) -> bool:
        """Tell whether a signal raises an error; what the model says of it only explains it."""
        return key in self._severities

    def names_of(self, part: PartName | None) -> Iterable[str]:
        """Return all errors of a part, those of signals last; None: of the robot itself."""
        of_signals = self._of_signals.get(part, ())
        if part is not None:
            yield from (name for name in self.causes.names_of(part) if name not in of_signals)
        yield from dict.fromkeys(of_signals)

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

    def explanation_of(self, key: ErrorKey) -> tuple[tuple[ErrorKey, ...], tuple[ErrorKey, ...]]:
        """Return which causes of an error are on, and their roots; of each, only the first ones."""
        known = self.causes.present(key, self.on.parts_by_name, self.is_on)
        given = filter(self.is_on, self._given.get(key, ()))
        causes = tuple(islice(dict.fromkeys(chain(known, given)), MAX_SHOWN))
        found = (self._open[cause].roots or (cause,) for cause in causes)
        return causes, tuple(islice(dict.fromkeys(chain.from_iterable(found)), MAX_SHOWN))

    def told_by(self, key: ErrorKey) -> int | None:
        """Return the newest event that told of an error; None: there is none."""
        return self._told.get(key)

    def open_ones(self) -> Mapping[str, ErrorView]:
        """Return the errors that are not normal, or shelved, by their names."""
        return {key.name: view for key, view in self._open.items()}

    @property
    def parts_with(self) -> Mapping[str, int]:
        """Return by error how many parts have it now."""
        return {error: len(parts) for error, parts in self.on.parts_by_name.items()}

    # --- inside ----------------------------------------------------------------------------------

    def _severity_of(self, key: ErrorKey) -> Severity:
        if (severity := self._severities.get(key)) is not None:
            return severity
        return self.causes.severity_of(key)

    def _hint_of(self, key: ErrorKey) -> str:
        declared = self.causes.declared.get(key)
        return "" if declared is None else declared.hint

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
        is_less = found.lingers or not found.message or found.state is ErrorState.PENDING
        if after.unseen and is_less:
            # What nobody has seen stays readable: what was measured, and not that it is over, or
            # that it may come again.
            found = Found(found.state, known.message, known.value, known.threshold)
        raised = state.is_on and not was_on
        # What returned is still shown under its root.
        is_explained = (was_on and state.is_on) or state is ErrorState.RETURNED
        view = replace(
            known,
            caused_by=known.caused_by if is_explained else (),
            roots=known.roots if is_explained else (),
            state=state,
            message=found.message,
            value=found.value,
            threshold=found.threshold,
            since=began,
            ended=after.ended,
            count=known.count + raised,
        )
        self._put(view)
        if state.is_on is not was_on:
            self._turns.append(Turn(view.key, raised, self._outbox.now, before.ended))
            self._switch(view.key, on=raised)
        view = self.view(view.key)
        is_announced = view.is_root or self._is_kept_as_such(view.key)
        too_many = self._alarms.put(view, after, is_announced=is_announced)
        if too_many is not None:
            self._see(too_many)

    def _is_kept_as_such(self, key: ErrorKey) -> bool:
        """Tell whether it is kept that nobody saw an error, though it follows from others.

        What is on without a word is kept as an earlier run left it.
        """
        return key in self._latching or key in self._silent

    def _is_seen_with_roots(self, view: ErrorView) -> bool:
        """Tell whether an error follows from others that somebody has seen, all of them."""
        return bool(view.roots) and not any(self._alarms[root].unseen for root in view.roots)

    def _put(self, view: ErrorView) -> None:
        is_open = view.is_open
        here, there = (self._open, self._ended) if is_open else (self._ended, self._open)
        there.pop(view.key, None)
        if is_open or view.count or view.marks != NO_MARKS:
            here[view.key] = view
        else:
            here.pop(view.key, None)
        self._outbox.errors.add(view.key)
        self._put_severe(view)

    def _put_severe(self, view: ErrorView) -> None:
        """Signals set the bits of their errors themselves, and declare each of them."""
        if view.key.part is not None and not self.is_of_signal(view.key):
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
            return
        self._given.pop(key, None)
        if self.on.is_empty:
            self._mark_first(None)

    def _note_rank(self, key: ErrorKey) -> None:
        """Find which error was first anew, since one of those that can be has another rank.

        A thousand nodes may be lost at once, of which none was first.
        """
        if key != self._first:
            if self._rank(key) < self._rank(self._first):
                self._mark_first(key)
            return
        are_on = (each for each in self.on.contenders if each in self.on)
        self._mark_first(min(are_on, key=self._rank))

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
