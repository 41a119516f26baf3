"""The built-in errors of parts as a concern: found from facts, from targets and from changes."""

from collections.abc import Collection, Container, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice

from domain.actor import NOBODY, Actor
from domain.concern import Concern, Takers
from domain.deadlines import SharedDeadlines
from domain.errors import shortened
from domain.events.changes import ChangeEnded
from domain.events.event import because
from domain.events.service import NotRestored
from domain.findings import Blocker
from domain.health.built_in_errors import (
    CHANGE_FAILED,
    DEVIATES,
    ERROR_PROCESSING,
    INVARIANT_BROKEN,
    PARAMETERS_DRIFTED,
    UNREACHABLE,
)
from domain.health.drift import drifted_parameter
from domain.health.error_causes import MAX_SHOWN
from domain.health.error_list import ErrorList, Found
from domain.health.severe_errors import reason_of
from domain.inputs import NodeReport, Restored
from domain.kept import KeptFailedChange
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.node_facts import NodeFacts
from domain.parts.parts import Parts
from domain.snapshot import ChangeStatus, ErrorKey, ErrorState, ErrorView
from domain.state_and_mode import PartName
from domain.timebase import Instant, seconds

DEVIATES_AFTER = seconds(1)
"""How long a part may deviate from its target, with no change under way, before it is an error."""

LOOKS_AT_ONCE = 100
"""Parts that one turn looks at, or whose errors it raises; the others follow in later turns."""

MAX_MESSAGE = 500
"""Characters of a message; a change of many nodes may fail for many reasons."""

_ACTIVE = ErrorState.ACTIVE
_FAILURES = (ChangeStatus.FAILED, ChangeStatus.TIMED_OUT)


@dataclass(frozen=True, slots=True)
class _Origin:
    """The input because of which a part is looked at, or began to deviate."""

    event: int
    actor: Actor
    at: Instant


class PartErrors(Concern):
    """Raises and clears the built-in errors; one of a part never raises one of another part.

    A node is UNREACHABLE until it is first heard of. That is neither told as raised nor as cleared:
    it is how each node of each robot begins. That a part deviates because of such a node is how the
    robot begins too: once the node is heard, whether the part deviates is judged anew.
    """

    def __init__(self, parts: Parts, errors: ErrorList, outbox: Outbox, start: Instant) -> None:
        self.model = parts.model
        self._parts = parts
        self._errors = errors
        self._outbox = outbox
        self._rank = {part: number for number, part in enumerate(parts.model.parts)}
        """Order of the model file: of several errors at once, the first is the first out."""
        self._unheard = set(parts.model.nodes)
        """Nodes that are unreachable since the start."""
        self._reported: set[PartName] = set()
        """Nodes that reported parameters since the last `settle`."""
        self._to_look: dict[PartName, _Origin] = {}
        """Parts that later turns look at."""
        self._in_order = True
        """Whether those are in the order of the file."""
        self._deviating: dict[PartName, _Origin] = {}
        """Parts that deviate with no change under way, and what began it."""
        self._from_start: set[PartName] = set()
        """Those of them that are not told, since a node below them was only now or never heard."""
        self._deadlines: SharedDeadlines[PartName] = SharedDeadlines()
        self._due: dict[PartName, Instant] = {}
        """Parts whose time is up, and when it was; later turns raise their errors."""
        self._drifted: set[PartName] = set()
        self._failed: set[PartName] = set()
        for node in parts.model.nodes:
            unheard = Found(_ACTIVE, f"{node} was never heard of")
            self._errors.note(ErrorKey(node, UNREACHABLE), unheard, start)

    # --- what happens ----------------------------------------------------------------------------

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {Restored: self.take_restored, NodeReport: self.take_report}

    def take_restored(self, restored: Restored, now: Instant) -> None:
        """Raise CHANGE_FAILED again; the other errors are found again from facts."""
        for kept in restored.kept:
            if not isinstance(kept, KeptFailedChange):
                continue
            if kept.part not in self._parts.model:
                self._outbox.forget(KeptFailedChange, kept.name)
                why = f"there is no part {kept.part} any more"
                self._outbox.emit(NotRestored(f"the failed change of {kept.part}", why))
                continue
            self._failed.add(kept.part)
            found = Found(_ACTIVE, kept.message, kept.status)
            self._raise(kept.part, CHANGE_FAILED, found, min(kept.since, now))

    def take_report(self, report: NodeReport, now: Instant) -> None:
        """Note that parameters may have drifted; all else of a report changes a view."""
        if report.parameters or report.node in self._unheard:
            self._reported.add(report.node)

    def note_end(
        self,
        ended: ChangeEnded,
        event: int,
        driven: Iterable[Container[PartName]],
        missed: Collection[PartName],
        now: Instant,
    ) -> None:
        """Note how a change ended: CHANGE_FAILED stands until one that drove the part succeeds.

        It follows from UNREACHABLE if no other node than unreachable ones failed.

        Args:
            ended: How it ended; superseded and canceled ones say nothing about a part.
            event: The id under which that was recorded.
            driven: Parts that it drove besides the requested one.
            missed: Nodes that did not get where they should.
            now: The current time.
        """
        part, status = ended.part, ended.status
        if status is ChangeStatus.SUCCEEDED:
            for failed in self._sorted(self._failed):
                if failed == part or any(failed in parts for parts in driven):
                    self._failed.discard(failed)
                    self._outbox.forget(KeptFailedChange, failed)
                    self._clear(failed, CHANGE_FAILED, event)
        elif status in _FAILURES and part in self._rank:
            how = f"change {ended.change} {status.replace('_', ' ')}"
            message = shortened(because(how, ended.reason), MAX_MESSAGE)
            self._failed.add(part)
            lost = tuple(ErrorKey(n, UNREACHABLE) for n in missed if not self._is_reachable(n))
            causes = lost if len(lost) == len(missed) else ()
            self._errors.explain(ErrorKey(part, CHANGE_FAILED), causes[:MAX_SHOWN])
            self._raise(part, CHANGE_FAILED, Found(_ACTIVE, message, str(status)), now, event)
            since = self._view(part, CHANGE_FAILED).since or now
            self._outbox.keep(KeptFailedChange(part, ended.change, message, str(status), since))

    def note_invariant(
        self, part: PartName, broken: Blocker | None, cause: int | None, now: Instant
    ) -> bool:
        """Raise INVARIANT_BROKEN of a part, or clear it; return whether that changed anything.

        Args:
            part: The part.
            broken: Which invariant of the mode in force is broken for too long; None: none is.
            cause: Id of the event with which it broke; None: of the current input.
            now: The current time.
        """
        was_on = self._errors.is_on(ErrorKey(part, INVARIANT_BROKEN))
        if broken is None:
            self._clear(part, INVARIANT_BROKEN)
            return was_on
        message = shortened(broken.message, MAX_MESSAGE)
        self._raise(part, INVARIANT_BROKEN, Found(_ACTIVE, message), now, cause)
        return not was_on

    def note_found(self, node: PartName, error: str, found: Found | None, now: Instant) -> None:
        """Raise an error of a node that another concern looks for, or clear it.

        Args:
            node: The node.
            error: Which error.
            found: What is wrong; None: nothing is.
            now: The current time.
        """
        if found is None:
            self._clear(node, error)
        else:
            self._raise(node, error, found, now)

    def wake_at(self) -> Instant | None:
        """Return when a deviation becomes an error; None: none will."""
        return self._deadlines.next()

    def pass_time(self, now: Instant) -> None:
        """Raise the errors that are due; those of many parts in later turns."""
        while parts := self._deadlines.pop_due(now):
            for part in parts:
                self._due[part] = self._deviating[part].at + DEVIATES_AFTER
        if len(self._due) <= LOOKS_AT_ONCE:
            self._raise_due()

    def settle(self, now: Instant) -> bool:
        """Look at the parts that changed, or let later turns do so; return whether there are any.

        Of many that changed at once, those that a change drives can have no new error.
        """
        changed, self._reported = self._parts.take_changed() | self._reported, set()
        if not changed:
            return False
        if len(changed) > LOOKS_AT_ONCE:
            # In bulk: a request may change ten thousand.
            known = self._deviating.keys() | self._drifted
            changed = (changed - self._parts.driven) | (changed & known)
        if len(changed) > LOOKS_AT_ONCE:
            origin = _Origin(self._outbox.record_input(), self._outbox.actor, now)
            self._to_look.update(dict.fromkeys(changed, origin))
            self._in_order = False
            return True
        for part in self._sorted(changed):
            postponed = self._to_look.pop(part, None)
            self._look(part, now if postponed is None else postponed.at)
        return True

    @property
    def has_more(self) -> bool:
        """Tell whether parts are still to be looked at, or errors to be raised."""
        return bool(self._due or self._to_look)

    def go_on(self, now: Instant) -> None:
        """Raise some more errors that are due, or else look at some more parts."""
        if self._due:
            part = next(iter(self._due))
            self._outbox.resume(now, self._deviating[part].event, NOBODY)
            self._raise_due()
            return
        if not self._in_order:
            self._to_look = {part: self._to_look[part] for part in self._sorted(self._to_look)}
            self._in_order = True
        for part in list(islice(self._to_look, LOOKS_AT_ONCE)):
            origin = self._to_look.pop(part)
            self._outbox.resume(now, origin.event, origin.actor)
            self._look(part, origin.at)

    # --- what can be seen ------------------------------------------------------------------------

    def names_of(self, part: PartName) -> Iterable[str]:
        """Return the errors that a part can have, apart from those of signals."""
        names = self._errors.causes.names_of(part)
        if part not in self._parts.model.errors:
            return names
        return [name for name in names if not self._errors.is_of_signal(ErrorKey(part, name))]

    @property
    def unheard(self) -> Container[PartName]:
        """Return the nodes that were not heard of since the start."""
        return self._unheard

    def views_of(self, part: PartName) -> Iterator[ErrorView]:
        """Yield the errors of a part, also those that were never raised."""
        for error in self.names_of(part):
            yield self._view(part, error)

    def reason(self, part: PartName, error: str) -> Blocker | None:
        """Return why an error of a part is active; None: it is not, or the part has none such."""
        if not self._errors.is_on(ErrorKey(part, error)):
            return None
        return reason_of(self._view(part, error), self._errors.view)

    # --- inside ----------------------------------------------------------------------------------

    def _view(self, part: PartName, error: str) -> ErrorView:
        return self._errors.view(ErrorKey(part, error))

    def _is_reachable(self, node: PartName) -> bool:
        return bool(self._parts.facts[node].reachable)

    def _sorted(self, parts: Iterable[PartName]) -> list[PartName]:
        return sorted(parts, key=self._rank.__getitem__)

    def _look(self, part: PartName, since: Instant) -> None:
        """Judge a part by what is known of it now.

        Args:
            part: The part.
            since: When it came to be so.
        """
        facts = self._parts.facts.get(part)
        if facts is not None:
            self._look_at_node(part, facts, since)
        self._look_at_deviation(part, since)
        if part in self._deviating and self._errors.is_on(ErrorKey(part, DEVIATES)):
            self._note(part, DEVIATES, self._deviation(part, _ACTIVE), since)

    def _look_at_node(self, node: PartName, facts: NodeFacts, since: Instant) -> None:
        if facts.reachable and node in self._unheard:
            self._unheard.discard(node)
            self._errors.forget(ErrorKey(node, UNREACHABLE))
            self._judge_anew(node, since)
        elif node not in self._unheard:
            words = "" if facts.reachable else f"{node} is unreachable"
            self._set(node, UNREACHABLE, words, since)
        is_bad = facts.known_state is LifecycleState.ERROR_PROCESSING
        self._set(node, ERROR_PROCESSING, f"{node} is in errorprocessing" if is_bad else "", since)
        self._look_at_drift(node, facts, since)

    def _judge_anew(self, node: PartName, since: Instant) -> None:
        """Give the systems above a node that is heard for the first time a second from now.

        Its state may be known only a moment later. What was told before is not taken back.
        """
        above = self._parts.model.ancestors[node]
        for system in above:
            if system in self._deviating and not self._is_told(system):
                self._from_start.add(system)
            self._look_at_deviation(system, since)

    def _look_at_drift(self, node: PartName, facts: NodeFacts, since: Instant) -> None:
        drift = None
        if facts.known_state is LifecycleState.ACTIVE and self._parts.change_of(node) is None:
            drift = drifted_parameter(self._parts, node)
        if drift is not None:
            self._drifted.add(node)
            found = Found(_ACTIVE, drift.message, drift.value, drift.wanted)
            self._raise(node, PARAMETERS_DRIFTED, found, since)
        elif node in self._drifted:
            self._drifted.discard(node)
            self._clear(node, PARAMETERS_DRIFTED)

    def _look_at_deviation(self, part: PartName, since: Instant) -> None:
        """Judge whether a part deviates, and those above it, which may do so because of it.

        Once what it waited for is heard, it begins anew: so long it was only how the robot begins.
        """
        deviated, deviates = part in self._deviating, self._deviates(part)
        is_told = self._is_told(part)
        waits = deviates and not is_told and self._waits_for_node(part)
        begins_anew = part in self._from_start and not (waits or is_told)
        (self._from_start.add if waits else self._from_start.discard)(part)
        if deviated is deviates and not begins_anew:
            return
        if deviated:
            self._end_deviation(part)
        if deviates:
            self._begin_deviation(part, since)
        for system in self._parts.model.ancestors[part]:
            self._look_at_deviation(system, since)

    def _begin_deviation(self, part: PartName, since: Instant) -> None:
        """Let DEVIATES of a part be pending."""
        event, actor = self._outbox.record_input(), self._outbox.actor
        self._deviating[part] = _Origin(event, actor, since)
        self._deadlines.set(part, since + DEVIATES_AFTER)
        self._note(part, DEVIATES, self._deviation(part, ErrorState.PENDING), since)

    def _end_deviation(self, part: PartName) -> None:
        """Clear DEVIATES of a part, whatever has become of it."""
        del self._deviating[part]
        self._due.pop(part, None)
        self._deadlines.clear(part)
        self._clear(part, DEVIATES)

    def _waits_for_node(self, part: PartName) -> bool:
        """Tell whether a part deviates because of a node that was never heard of.

        A node that was just heard may still have to be looked at.
        """
        cause = self._parts.inference.deviation_cause(part)
        return cause is not None and cause in self._unheard and not self._is_reachable(cause)

    def _is_told(self, part: PartName) -> bool:
        key = ErrorKey(part, DEVIATES)
        return self._errors.is_on(key) and not self._errors.is_silent(key)

    def _deviates(self, part: PartName) -> bool:
        """Tell whether a part is not where its target says, and no change works on that."""
        cause = self._parts.inference.deviation_cause(part)
        if cause is None or self._parts.target(part) is None:
            return False
        return self._parts.change_of(part) is None and self._parts.change_of(cause) is None

    def _deviation(self, part: PartName, state: ErrorState) -> Found:
        actual, target = self._parts.inference.actual(part), self._parts.target(part)
        why = self._parts.inference.deviation_reason(part) or ""
        label = None if target is None else target.label
        return Found(state, why, actual.state_and_mode.label, label)

    def _raise_due(self) -> None:
        """Raise DEVIATES of some parts whose time is up."""
        for part in list(islice(self._due, LOOKS_AT_ONCE)):
            since, origin = self._due.pop(part), self._deviating[part]
            found = self._deviation(part, _ACTIVE)
            if part in self._from_start:
                self._errors.raise_silently(ErrorKey(part, DEVIATES), found, since)
            else:
                self._raise(part, DEVIATES, found, since, origin.event)

    def _set(self, part: PartName, error: str, words: str, since: Instant) -> None:
        """Raise an error with a message, or clear it if that is empty."""
        if words:
            self._raise(part, error, Found(_ACTIVE, words), since)
        else:
            self._clear(part, error)

    def _raise(
        self, part: PartName, error: str, found: Found, since: Instant, cause: int | None = None
    ) -> None:
        """Raise an error, or note what is found of one that is on already."""
        self._errors.raise_(ErrorKey(part, error), found, since, cause)

    def _clear(self, part: PartName, error: str, cause: int | None = None) -> None:
        """Clear an error if it is on, or pending."""
        key = ErrorKey(part, error)
        if self._errors.is_on(key) or error == DEVIATES:
            self._errors.clear(key, cause)

    def _note(self, part: PartName, error: str, found: Found, since: Instant) -> None:
        self._errors.note(ErrorKey(part, error), found, since)
