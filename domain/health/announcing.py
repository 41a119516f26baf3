"""Announcing as a concern: who has seen which error, and what is silenced.

Nothing here changes whether an error is on, except that an error which only waited for somebody to
acknowledge it ends.
"""

from domain.concern import Concern, Takers
from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth
from domain.conditions.watched import WatchedConditions
from domain.errors import InvalidValueError, UnknownErrorNameError, UnknownPartError
from domain.events.announcing import ErrorChattering, ErrorShelved, ErrorUnshelved
from domain.events.health import ErrorAcknowledged
from domain.events.service import NotRestored
from domain.health.chatter import Chatter
from domain.health.health import Health
from domain.health.part_errors import PartErrors
from domain.health.shelf import Shelf, shelves_after
from domain.inputs import (
    MAX_SHELF,
    AcknowledgeRequest,
    Restored,
    ShelveRequest,
    UnshelveRequest,
)
from domain.kept import KeptShelf, KeptUnacknowledged
from domain.outbox import Outbox
from domain.parts.system_model import SmhModel
from domain.snapshot import ErrorKey, ErrorMarks, ShelfView
from domain.state_and_mode import PartName
from domain.timebase import Instant, to_seconds


class Announcing(Concern):
    """Takes acknowledgements, shelves errors, and tells which ones are suppressed or chatter."""

    def __init__(
        self,
        health: Health,
        part_errors: PartErrors,
        watched: WatchedConditions,
        outbox: Outbox,
        start: Instant,
    ) -> None:
        """Begin with nothing shelved.

        Args:
            health: The errors of the robot itself, and the list of all.
            part_errors: The errors of parts, and the model, which says when some are suppressed.
            watched: Keeps the conditions up to date by which errors are suppressed.
            outbox: Receives events.
            start: The current time.
        """
        model = self._model = part_errors.model
        self._health = health
        self._part_errors = part_errors
        self._errors = health.error_list
        self._watched = watched
        self._outbox = outbox
        self._shelf = Shelf(outbox)
        self._chatter = Chatter()
        self._suppressing = _suppressing(model)
        """By the condition that silences them, errors."""
        for part, declared in model.errors.items():
            for name, error in declared.items():
                if error.needs_acknowledgement:
                    self._errors.declare(ErrorKey(part, name), latches=True)
        self._changed = watched.follow(self._suppressing, start)
        """Conditions whose value changed, by their text."""
        self._suppressed = set[ErrorKey]()

    # --- what happens ----------------------------------------------------------------------------

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {
            AcknowledgeRequest: self.acknowledge,
            ShelveRequest: self.shelve,
            UnshelveRequest: self.unshelve,
            Restored: self.restore,
        }

    def acknowledge(self, request: AcknowledgeRequest, now: Instant) -> None:
        """Note that somebody has seen an error; it may clear once its cause is gone.

        Raises:
            UnknownNameError: There is no such part or error.
        """
        key = self._checked(request)
        acknowledged = ErrorAcknowledged(key.error, key.part)
        self._outbox.begin(now, acknowledged, request.actor)
        self._health.acknowledge(key, now)
        before = self._errors.view(key)
        if not self._errors.acknowledge(key):
            return
        self._outbox.record_input()
        if before.state.is_on and not self._errors.is_on(key):
            self._errors.tell_cleared(before)

    def shelve(self, request: ShelveRequest, now: Instant) -> None:
        """Announce an error no more for a time; a repetition begins the time anew.

        Raises:
            UnknownNameError: There is no such part or error.
            InvalidValueError: The time is too long or none, or there is no reason.
        """
        key = self._checked(request)
        if not 0 < request.for_ <= MAX_SHELF:
            most = to_seconds(MAX_SHELF)
            raise InvalidValueError(f"for_s must be more than 0 and at most {most:g}", "/for_s")
        if not request.reason.strip():
            raise InvalidValueError("an error is shelved for a reason", "/reason")
        shelved = ErrorShelved(key.error, to_seconds(request.for_), request.reason, key.part)
        self._outbox.begin(now, shelved, request.actor)
        view = ShelfView(now + request.for_, request.reason, request.actor.label)
        self._shelf.put(key, view, self._outbox.record_input(), now)
        self._mark(key)

    def unshelve(self, request: UnshelveRequest, now: Instant) -> None:
        """Announce an error again.

        Raises:
            UnknownNameError: There is no such part or error.
        """
        key = self._checked(request)
        self._outbox.begin(now, ErrorUnshelved(key.error, key.part), request.actor)
        if self._shelf.remove(key) is not None:
            self._outbox.record_input()
            self._mark(key)

    def restore(self, restored: Restored, now: Instant) -> None:
        """Bring back what was shelved, and which errors nobody acknowledged."""
        for key, view in shelves_after(restored.kept, now).items():
            if self._is_known(key, KeptShelf, f"the shelving of {key.name}"):
                self._shelf.put(key, view, self._outbox.record_input(), now)
                self._mark(key)
        for kept in restored.kept:
            if isinstance(kept, KeptUnacknowledged):
                self._restore(kept, now)

    def wake_at(self) -> Instant | None:
        """Return when an error is no longer shelved, or calm."""
        due = [at for at in (self._shelf.wake_at(), self._chatter.wake_at()) if at is not None]
        return min(due, default=None)

    def pass_time(self, now: Instant) -> None:
        """Take errors off the shelf whose time is up, and calm those that have calmed down."""
        for key, shelved in self._shelf.pass_time(now):
            self._outbox.emit(ErrorUnshelved(key.error, key.part), shelved.event)
            self._mark(key)
        while (calm := self._chatter.pop_calm(now)) is not None:
            self._mark(calm)

    def settle(self, now: Instant) -> bool:
        """Look which errors turned, and which are suppressed; nothing follows from that here."""
        for turn in self._errors.take_turns():
            self._chatter.note(turn)
            self._mark(turn.key)
        if self._changed:
            self._suppress()
        return False

    # --- inside ----------------------------------------------------------------------------------

    def _checked(self, request: AcknowledgeRequest | ShelveRequest | UnshelveRequest) -> ErrorKey:
        """Return which error a request means."""
        part = request.part
        if part is not None and not self._is_there(part):
            raise UnknownPartError("part", part, self._model.parts)
        names = self._names(ErrorKey(part, request.error))
        if request.error not in names:
            raise UnknownErrorNameError("error", request.error, names)
        return ErrorKey(part, request.error)

    def _names(self, key: ErrorKey) -> tuple[str, ...]:
        """Return the names of all errors of the part of an error, or of the robot itself."""
        of_signals = (view.key.error for view in self._health.error_views(key.part))
        if key.part is None:
            return tuple(of_signals)
        if not self._is_there(key.part):
            return ()
        return (*self._part_errors.names_of(key.part), *of_signals)

    def _is_there(self, part: PartName) -> bool:
        """Tell whether there is a part, or a device, of a name."""
        return part in self._model or part in self._errors.causes.devices

    def _is_known(self, key: ErrorKey, kind: type, what: str) -> bool:
        """Tell whether an error of an earlier run still exists; one that does not is forgotten."""
        if key.error in self._names(key):
            return True
        self._outbox.forget(kind, key.name)
        self._outbox.emit(NotRestored(what, "there is no such error any more"))
        return False

    def _restore(self, kept: KeptUnacknowledged, now: Instant) -> None:
        key = ErrorKey(kept.part, kept.error)
        if not self._is_known(key, KeptUnacknowledged, f"the error {key.name}"):
            return
        was_on = self._errors.is_on(key)
        self._errors.restore(kept, now)
        if not was_on and self._errors.is_on(key):
            self._errors.tell_raised(key)

    def _suppress(self) -> None:
        """Silence errors, or no longer, as the conditions that changed say."""
        for condition in self._changed.values():
            keys = self._suppressing[condition]
            if self._watched.truth(condition) is Truth.TRUE:
                self._suppressed.update(keys)
            else:
                self._suppressed.difference_update(keys)
            for key in keys:
                self._mark(key)
        self._changed.clear()

    def _mark(self, key: ErrorKey) -> None:
        """Tell what is so about the announcing of an error now."""
        chattering = self._chatter.find(key)
        calming = None if chattering is None else chattering.calming
        if chattering is not None and not self._errors.view(key).marks.chattering:
            words = ErrorChattering(key.error, to_seconds(chattering.calming), key.part)
            self._outbox.emit(words)
        suppressed = key in self._suppressed
        marks = ErrorMarks(self._shelf[key], suppressed, chattering is not None, calming)
        self._errors.mark(key, marks)


def _suppressing(model: SmhModel) -> dict[Condition, list[ErrorKey]]:
    """Return by condition the errors that it silences, in the order of the model file."""
    found: dict[Condition, list[ErrorKey]] = {}
    for part, declared in model.errors.items():
        for name, error in declared.items():
            if error.suppressed_when is not None:
                found.setdefault(error.suppressed_when, []).append(ErrorKey(part, name))
    return found
