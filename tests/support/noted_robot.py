"""A robot whose steps are noted in a journal; it decides nothing, and counts as the core does."""

from datetime import UTC, datetime, timedelta

from domain.actor import NOBODY, Actor
from domain.events.changes import ChangeRequested, StepStarted
from domain.events.driving import HoldReleased, HoldSet
from domain.events.event import Event, RecordedEvent
from domain.identifiers import ChangeId
from domain.inputs import HoldRequest, Input, ModeRequest, Reading, Readings, ReleaseRequest
from domain.kept import Keeping, KeptHold
from domain.outbox import NOTHING, Outputs
from domain.state_and_mode import ModeName, PartName
from domain.timebase import Instant, seconds
from service.storage.journal import Boot, Journal, Step
from tests.support.manual_clock import START

ADA = Actor("ada", "http", "10.0.0.7")


def boot(number: int, started_at: Instant = 0) -> Boot:
    """Return the run of a number, each with an epoch of its own."""
    wall_at = START + timedelta(days=number)
    return Boot(f"epoch-{number}", "1.2.3", started_at, wall_at, "model: text", "name: robot")


class NotedRobot:
    """Gives its journal one step after the other, `PERIOD` apart."""

    PERIOD = seconds(0.05)

    def __init__(self, journal: Journal) -> None:
        self.journal = journal
        self.now = journal.boot.started_at
        first = journal.found.restored
        self.next_event, self.next_change = first.next_event, first.next_change

    def reads(self, value: float = 0.8) -> None:
        """Take a reading in, from which nothing follows."""
        self._note(Readings((Reading("battery_level", value),), "battery"), NOTHING)

    def holds(self, owner: str, reason: str = "lunch") -> None:
        """Set a hold, which is kept."""
        kept = KeptHold(owner, reason, ADA.label, self.now)
        events = self._events(HoldSet(owner, reason), actor=ADA)
        changed = (Keeping(KeptHold, owner, kept),)
        self._note(HoldRequest(owner, reason, ADA), Outputs(events=events, kept=changed))

    def steps_into_much(self, count: int) -> None:
        """Take in what as many events follow from."""
        events = self._events(*(HoldSet(f"owner {number}", "lunch") for number in range(count)))
        self._note(HoldRequest("operator", "lunch", ADA), Outputs(events=events))

    def releases(self, owner: str) -> None:
        """Release a hold, which is kept no longer."""
        events = self._events(HoldReleased(owner), actor=ADA)
        changed = (Keeping(KeptHold, owner, None),)
        self._note(ReleaseRequest(owner, ADA), Outputs(events=events, kept=changed))

    def changes(self, part: str, mode: str) -> str:
        """Begin a change, and return its id."""
        identity = ChangeId(f"c{self.next_change}")
        self.next_change += 1
        name = PartName(part)
        events = self._events(ChangeRequested(name, mode), StepStarted(identity, name, "configure"))
        given = ModeRequest(name, ModeName(mode), ADA)
        self._note(given, Outputs(events=events, change=identity))
        return identity

    def _events(self, *events: Event, actor: Actor = NOBODY) -> tuple[RecordedEvent, ...]:
        first = self.next_event
        self.next_event += len(events)
        return tuple(
            RecordedEvent(first + n, self.now + self.PERIOD, first if n else None, actor, event)
            for n, event in enumerate(events)
        )

    def _note(self, given: Input, outputs: Outputs) -> None:
        self.now += self.PERIOD
        self.journal.note(Step(self.now, given, False, outputs))


def wall(text: str) -> datetime:
    """Return a time of day on the day that tests happen."""
    return datetime.fromisoformat(f"2026-01-01T{text}").replace(tzinfo=UTC)


def hold_set(number: int, at: Instant) -> RecordedEvent:
    """Return an event of an id."""
    return RecordedEvent(number, at, None, ADA, HoldSet("operator", "lunch"))
