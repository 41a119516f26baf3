"""The errors that the model file declares, as a concern: detected, and following from others.

All are decided in one pass, each after what it depends on, so that nothing is raised and cleared
again in the same step.
"""

import heapq
from collections.abc import Collection, Container, Iterable, Mapping

from domain.actor import Actor
from domain.concern import Concern
from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth
from domain.conditions.tree import Topic, TopicKind, comparisons
from domain.conditions.watched import WatchedConditions
from domain.deadlines import Deadlines
from domain.events.health import PropagationNotSeen
from domain.health.error_causes import Place
from domain.health.error_list import NORMAL, ErrorList, Found
from domain.outbox import Outbox
from domain.parts.declared_errors import DeclaredError
from domain.snapshot import ErrorKey, ErrorState
from domain.timebase import Instant, to_seconds

LOOKS_AT_ONCE = 100
"""Errors that one turn decides about; the others follow in later turns."""


class Propagation(Concern):
    """Raises and clears declared errors, and keeps the roots of all errors up to date."""

    def __init__(
        self,
        errors: ErrorList,
        watched: WatchedConditions,
        unheard: Mapping[str, Container[str]],
        outbox: Outbox,
        start: Instant,
    ) -> None:
        """Follow conditions and errors.

        Args:
            errors: All errors, and which explain which.
            watched: Keeps conditions up to date.
            unheard: By error, the nodes and devices that have it since the start. What goes back
                to them alone is on without a word, as they are unreachable without a word.
            outbox: Receives events.
            start: The current time.
        """
        self._errors = errors
        self._causes = errors.causes
        self._watched = watched
        self._unheard = unheard
        self._outbox = outbox
        self._users: dict[str, list[ErrorKey]] = {}
        """By text of a condition, the errors that it decides about."""
        for key, own in self._causes.declared.items():
            for condition in (own.when, own.unless):
                if condition is not None:
                    self._users.setdefault(condition.text, []).append(key)
        self._changed = watched.follow(self._conditions(), start)
        self._heap: list[tuple[Place, ErrorKey]] = []
        self._queued = set[ErrorKey]()
        self._origin: tuple[int, Actor] | None = None
        """The input that left work for later turns."""
        self._present = set[ErrorKey]()
        """Errors that are declared and whose cause is present."""
        self._on_since: dict[ErrorKey, Instant] = {}
        self._pending: dict[ErrorKey, int] = {}
        """Errors that are due unless their cause ends, and the event with which it began."""
        self._deadlines: Deadlines[ErrorKey] = Deadlines()
        self._expected: Deadlines[tuple[ErrorKey, ErrorKey]] = Deadlines()
        """When an error should have followed a cause."""
        self._overdue: list[tuple[ErrorKey, ErrorKey]] = []
        """Those of which the time is up, unless they follow in this very step."""
        # What there is at the start is looked at in portions, as what many inputs bring.
        self._take_changed()
        self._take_switched(start)

    def _conditions(self) -> Iterable[Condition]:
        for own in self._causes.declared.values():
            yield from (each for each in (own.when, own.unless) if each is not None)

    # --- what happens ----------------------------------------------------------------------------

    def wake_at(self) -> Instant | None:
        """Return when an error is due, or should have followed."""
        due = (self._deadlines.next(), self._expected.next())
        return min((at for at in due if at is not None), default=None)

    def pass_time(self, now: Instant) -> None:
        """Let `settle` decide about what is due, and tell what did not follow in time."""
        while (key := self._deadlines.pop_due(now)) is not None:
            self._push(key)
        while (expected := self._expected.pop_due(now)) is not None:
            self._overdue.append(expected)

    def settle(self, now: Instant) -> bool:
        """Decide about what changed, or let later turns do so; return whether that changed errors.

        Many errors may change at once where one network connects ten thousand nodes.
        """
        self._take_changed()
        self._take_switched(now)
        moved = False
        if len(self._heap) <= LOOKS_AT_ONCE:
            moved = self._decide_some(now)
        overdue, self._overdue = self._overdue, []
        for expected in overdue:
            self._tell_not_seen(*expected)
        if self._heap and self._origin is None:
            self._origin = (self._outbox.record_input(), self._outbox.actor)
        return moved

    @property
    def has_more(self) -> bool:
        """Tell whether errors are still to be decided about."""
        return bool(self._heap)

    def go_on(self, now: Instant) -> None:
        """Decide about some more errors."""
        if self._origin is not None:
            self._outbox.resume(now, *self._origin)
        self._decide_some(now)
        if not self._heap:
            self._origin = None

    # --- the order of decisions ------------------------------------------------------------------

    def _push(self, key: ErrorKey) -> None:
        if key not in self._queued:
            self._queued.add(key)
            heapq.heappush(self._heap, (self._causes.place(key), key))

    def _take_changed(self) -> None:
        """Queue the errors whose conditions have other values."""
        if self._changed:
            for text in self._changed:
                for key in self._users.get(text, ()):
                    self._push(key)
            self._changed.clear()

    def _take_switched(self, now: Instant) -> bool:
        """Queue what depends on the errors that were raised or ended; return whether any was."""
        switched = self._errors.on.take_switched()
        for key in switched:
            self._note_switched(key, now)
            self._watched.touch(Topic(TopicKind.ERROR, key.error, key.part or ""))
            for effect in self._causes.effects(key, self._errors.is_on):
                self._push(effect)
        return bool(switched)

    def _decide_some(self, now: Instant) -> bool:
        """Decide about some errors in order; return whether any changed."""
        moved = False
        for _ in range(LOOKS_AT_ONCE):
            if not self._heap:
                break
            _, key = heapq.heappop(self._heap)
            self._queued.discard(key)
            own = self._causes.declared.get(key)
            if own is not None and own.when is not None:
                self._detect(key, own, own.when, now)
            elif own is not None and own.caused_by and not self._is_found_elsewhere(key):
                self._follow(key, own, now)
            if self._renew_roots(key):
                moved = True
            if self._take_switched(now):
                moved = True
                self._watched.renew(now, goes_on=True)
                self._take_changed()
        return moved

    def _note_switched(self, key: ErrorKey, now: Instant) -> None:
        """Note since when an error is on, and when others should have followed."""
        is_on = self._errors.is_on(key)
        if is_on:
            self._on_since[key] = now
        else:
            self._on_since.pop(key, None)
        for effect in self._causes.declared_effects(key):
            own = self._causes.declared[effect]
            if own.expected_within is None or key not in own.caused_by:
                continue
            if is_on and not self._is_unheard(key):
                self._expected.set((effect, key), now + own.expected_within)
            else:
                self._expected.clear((effect, key))

    # --- one error -------------------------------------------------------------------------------

    def _detect(self, key: ErrorKey, own: DeclaredError, when: Condition, now: Instant) -> None:
        """Decide about an error with a condition of its own; an unknown one keeps it as it is."""
        truth, since = self._watched.truth(when), self._watched.since(when)
        if self._errors.is_silent(key) and (truth is not Truth.TRUE or not self._is_unheard(key)):
            # That a node was not yet heard of begins nothing that stays.
            self._clear(key, None)
        if truth is Truth.TRUE and key not in self._present:
            if since + own.for_ > now:
                self._wait(key, since + own.for_, since)
            else:
                self._raise(key, self._found(own, when), now, self._pending.get(key))
        elif truth is Truth.FALSE and key in self._present:
            if since + own.clear_for > now:
                self._deadlines.set(key, since + own.clear_for)
            else:
                self._clear(key, None)
        else:
            # It is as it was, or it is not known for long enough to change.
            self._stop_waiting(key)

    def _found(self, own: DeclaredError, when: Condition) -> Found:
        leaves = list(comparisons(when.root))
        value = threshold = None
        if len(leaves) == 1 and len(leaves[0].values) == 1 and not leaves[0].stands_alone:
            value = self._watched.value_of(leaves[0].subject)
            threshold = leaves[0].values[0]
        return Found(ErrorState.ACTIVE, own.message or when.text, value, threshold)

    def _follow(self, key: ErrorKey, own: DeclaredError, now: Instant) -> None:
        """Decide about an error that follows from others."""
        is_on = self._errors.is_on
        gone = next((cause for cause in own.caused_by if not is_on(cause)), None)
        if gone is not None and (own.need_all or not any(map(is_on, own.caused_by))):
            self._end_following(key, self._errors.told_by(gone))
            return
        on = [cause for cause in own.caused_by if is_on(cause)]
        choose = max if own.need_all else min
        cause = choose(on, key=self._on_since.__getitem__)
        due = self._on_since[cause] + own.after
        if own.unless is not None and self._watched.truth(own.unless) is Truth.TRUE:
            self._end_following(key, None)
        elif due > now:
            self._end_following(key, self._errors.told_by(cause))
            self._wait(key, due, self._on_since[cause])
        elif key not in self._present:
            words = own.message or f"follows from {', '.join(each.name for each in on[:3])}"
            self._raise(key, Found(ErrorState.ACTIVE, words), now, self._errors.told_by(cause))

    def _end_following(self, key: ErrorKey, cause: int | None) -> None:
        if key in self._present:
            self._clear(key, cause)
        else:
            self._stop_waiting(key)

    def _wait(self, key: ErrorKey, due: Instant, since: Instant) -> None:
        """Let an error be pending until it is due."""
        self._deadlines.set(key, due)
        if key not in self._pending:
            self._pending[key] = self._outbox.record_input()
            if not self._errors.is_on(key):
                self._errors.note(key, Found(ErrorState.PENDING), since)

    def _stop_waiting(self, key: ErrorKey) -> None:
        self._deadlines.clear(key)
        if self._pending.pop(key, None) is not None and not self._errors.is_on(key):
            self._errors.note(key, NORMAL, 0)

    def _raise(self, key: ErrorKey, found: Found, now: Instant, cause: int | None) -> None:
        self._deadlines.clear(key)
        self._pending.pop(key, None)
        self._present.add(key)
        if self._errors.is_on(key) or not self._are_unheard(self._errors.explanation_of(key)[1]):
            self._errors.raise_(key, found, now, cause)
        else:
            self._errors.raise_silently(key, found, now)

    def _clear(self, key: ErrorKey, cause: int | None) -> None:
        self._deadlines.clear(key)
        self._present.discard(key)
        self._errors.clear(key, cause)

    def _renew_roots(self, key: ErrorKey) -> bool:
        """Find the roots of an error anew; return whether they changed."""
        if not self._errors.renew_roots(key):
            return False
        if self._errors.is_silent(key) and not self._is_unheard(key):
            self._errors.tell_raised(key)
        for effect in self._causes.effects(key, self._errors.is_on):
            self._push(effect)
        return True

    def _is_unheard(self, key: ErrorKey) -> bool:
        """Tell whether an error goes back to nothing but who was never heard of."""
        roots = self._errors.view(key).roots
        return self._are_unheard(roots) if roots else self._was_never_heard(key)

    def _are_unheard(self, roots: Collection[ErrorKey]) -> bool:
        """Tell whether errors go back to nothing else; of a silent one that may yet be looked for.

        Of thousands that are raised in turns, a system may come before what is below it.
        """
        is_silent = self._errors.is_silent
        return bool(roots) and all(self._was_never_heard(r) or is_silent(r) for r in roots)

    def _was_never_heard(self, key: ErrorKey) -> bool:
        return key.part is not None and key.part in self._unheard.get(key.error, ())

    def _is_found_elsewhere(self, key: ErrorKey) -> bool:
        """Tell whether its causes explain an error only: it is built in, or that of a signal."""
        return self._causes.is_built_in(key) or self._errors.is_of_signal(key)

    def _tell_not_seen(self, effect: ErrorKey, cause: ErrorKey) -> None:
        own = self._causes.declared[effect]
        if effect.part is None or own.expected_within is None or self._errors.is_on(effect):
            return
        within_s = to_seconds(own.expected_within)
        told = PropagationNotSeen(effect.error, effect.part, cause.error, cause.part, within_s)
        self._outbox.emit(told, self._errors.told_by(cause))
