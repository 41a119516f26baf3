"""Gathers what one input leads to: events with their cause, commands, and what looks different."""

from dataclasses import dataclass

from domain.actor import NOBODY, Actor
from domain.commands import Command
from domain.events.event import Event, RecordedEvent
from domain.events.service import TimeWasDue
from domain.identifiers import ChangeId, TaskId
from domain.state_and_mode import PartName
from domain.timebase import Instant


@dataclass(frozen=True, slots=True)
class Outputs:
    """What one input led to."""

    commands: tuple[Command, ...] = ()
    events: tuple[RecordedEvent, ...] = ()
    change: ChangeId | None = None
    """The change that a request began, or that was already there and is met."""
    parts: frozenset[PartName] = frozenset()
    """Parts whose view changed."""
    signals: frozenset[str] = frozenset()
    """Signals whose view changed."""
    system_state: bool = False
    """Whether the system state changed."""
    task: TaskId | None = None
    """The task that a request submitted."""
    task_changed: bool = False
    """Whether the view of the current task changed, or there is another one or none."""
    vehicle_changed: bool = False
    """Whether the vehicle moves differently, is told something else, or steers to another point."""


NOTHING = Outputs()


class Outbox:
    """Outputs while they are gathered.

    An input is recorded as an event only once something follows from it: ten readings a second that
    change nothing leave no trace, and the one that matters is there to be pointed at.
    """

    def __init__(self) -> None:
        self.change: ChangeId | None = None
        self.parts: set[PartName] = set()
        self.signals: set[str] = set()
        self.system_state = False
        self.task: TaskId | None = None
        self.task_changed = False
        self.vehicle_changed = False
        self._commands: list[Command] = []
        self._events: list[RecordedEvent] = []
        self._next_event = 1
        self._next_request = 1
        self._at: Instant = 0
        self._input: Event = TimeWasDue()
        self._actor = NOBODY
        self._cause: int | None = None
        self._input_id: int | None = None

    def begin(
        self, now: Instant, event: Event, actor: Actor = NOBODY, cause: int | None = None
    ) -> None:
        """Begin an input, which `event` describes; it is recorded when something follows from it.

        Args:
            now: When it arrived.
            event: What arrived.
            actor: Who sent it.
            cause: The event that it is a consequence of, if it is one.
        """
        self._at, self._input, self._actor, self._cause = now, event, actor, cause
        self._input_id = None

    def record_input(self) -> int:
        """Record the input itself now, if it was not yet; return its id."""
        if self._input_id is None:
            self._input_id = self._append(self._input, self._cause)
        return self._input_id

    def emit(self, event: Event, cause: int | None = None) -> int:
        """Record what follows from the input, or from `cause` if that is nearer; return its id."""
        return self._append(event, self.record_input() if cause is None else cause)

    def next_request(self) -> int:
        """Return a number for a command, never given before."""
        self._next_request += 1
        return self._next_request - 1

    def command(self, command: Command) -> None:
        """Send a command."""
        self._commands.append(command)

    def take(self) -> Outputs:
        """Return what was gathered since the last call."""
        if not self._has_anything():
            # Most inputs, such as reports of a vehicle at standstill, lead to nothing.
            return NOTHING
        outputs = Outputs(
            tuple(self._commands),
            tuple(self._events),
            self.change,
            frozenset(self.parts),
            frozenset(self.signals),
            self.system_state,
            self.task,
            self.task_changed,
            self.vehicle_changed,
        )
        self._commands, self._events = [], []
        self.change, self.system_state = None, False
        self.parts, self.signals = set(), set()
        self.task, self.task_changed, self.vehicle_changed = None, False, False
        return outputs

    def _has_anything(self) -> bool:
        return bool(
            self._events
            or self._commands
            or self.vehicle_changed
            or self.task_changed
            or self.parts
            or self.signals
            or self.system_state
            or self.change
            or self.task
        )

    def _append(self, event: Event, cause: int | None) -> int:
        recorded = RecordedEvent(self._next_event, self._at, cause, self._actor, event)
        self._next_event += 1
        self._events.append(recorded)
        return recorded.id
