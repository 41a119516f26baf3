"""Gathers the consequences of one input: commands, events with causes, and changed views."""

from typing import NamedTuple

from domain.actor import NOBODY, Actor
from domain.commands import Command
from domain.computers import ComputerName
from domain.events.event import Event, RecordedEvent
from domain.events.service import TimeWasDue
from domain.identifiers import ChangeId, TaskId
from domain.kept import Keeping, Kept
from domain.snapshot import ErrorKey
from domain.state_and_mode import PartName
from domain.timebase import Instant


class Outputs(NamedTuple):
    """The consequences of one input; a tuple, since there are thousands a second."""

    commands: tuple[Command, ...] = ()
    events: tuple[RecordedEvent, ...] = ()
    change: ChangeId | None = None
    """The change that the request began."""
    parts: frozenset[PartName] = frozenset()
    """Parts whose view changed."""
    signals: frozenset[str] = frozenset()
    """Signals whose view changed."""
    errors: frozenset[ErrorKey] = frozenset()
    """Errors whose view changed."""
    reactions: frozenset[str] = frozenset()
    """Reactions whose view changed, by their names."""
    system_state: bool = False
    """Whether the system state changed."""
    task: TaskId | None = None
    """The task that a request submitted."""
    task_changed: bool = False
    """Whether the view of the current task changed, or the task was replaced or ended."""
    vehicle_changed: bool = False
    """Whether the motion of the vehicle, its command or its look-ahead point changed."""
    kept: tuple[Keeping, ...] = ()
    """What changed of that which survives a restart; one entry per thing."""
    devices: frozenset[ComputerName] = frozenset()
    """Devices whose view changed."""


NOTHING = Outputs()


class Outbox:
    """Outputs while they are gathered.

    An input is recorded as an event only once something follows from it: ten readings per second
    that change nothing leave no trace, and the one that matters is there as a cause.
    """

    def __init__(self) -> None:
        self.change: ChangeId | None = None
        self.parts: set[PartName] = set()
        self.signals: set[str] = set()
        self.errors: set[ErrorKey] = set()
        self.reactions: set[str] = set()
        self.devices: set[ComputerName] = set()
        self.system_state = False
        self.task: TaskId | None = None
        self.task_changed = False
        self.vehicle_changed = False
        self._kept: dict[tuple[type[Kept], str], Keeping] = {}
        self._commands: list[Command] = []
        self._events: list[RecordedEvent] = []
        self.step = 0
        """Rises with each input, and with each portion of what an earlier one left."""
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
        """Begin an input; it is recorded once something follows from it.

        Args:
            now: When it arrived.
            event: Describes the input.
            actor: Who sent it.
            cause: Id of the event that led to this input, if any.
        """
        self._at, self._input, self._actor, self._cause = now, event, actor, cause
        self._input_id = None
        self.step += 1

    def number_events_from(self, first: int) -> None:
        """Give the next event this id: those before may have been told by an earlier run."""
        self._next_event = first

    @property
    def next_event(self) -> int:
        """Return the id that the next event gets."""
        return self._next_event

    @property
    def now(self) -> Instant:
        """Return the time of the current input."""
        return self._at

    @property
    def actor(self) -> Actor:
        """Return who sent the current input."""
        return self._actor

    def resume(self, now: Instant, recorded: int, actor: Actor) -> None:
        """Go on with an input that was recorded earlier; what follows is its consequence.

        Args:
            now: The current time.
            recorded: Its event id.
            actor: Who sent it.
        """
        self._at, self._actor, self._input_id = now, actor, recorded
        self.step += 1

    def record_input(self) -> int:
        """Record the input, unless it is recorded already; return its event id."""
        if self._input_id is None:
            self._input_id = self._append(self._input, self._cause)
        return self._input_id

    def emit(self, event: Event, cause: int | None = None) -> int:
        """Record an event and return its id.

        Args:
            event: What follows from the input.
            cause: Id of a more direct cause than the input; None: the input.
        """
        return self._append(event, self.record_input() if cause is None else cause)

    def next_request(self) -> int:
        """Return a new request number."""
        self._next_request += 1
        return self._next_request - 1

    def command(self, command: Command) -> None:
        """Send a command."""
        self._commands.append(command)

    def keep(self, value: Kept) -> None:
        """Keep a value over a restart; it replaces an earlier one of its kind and name."""
        self._kept[type(value), value.name] = Keeping(type(value), value.name, value)

    def forget(self, kind: type[Kept], name: str) -> None:
        """Keep a value no longer."""
        self._kept[kind, name] = Keeping(kind, name, None)

    def take(self) -> Outputs:
        """Return all outputs since the last call."""
        if not self._has_anything():
            # Most inputs, such as reports of a vehicle at standstill, lead to nothing.
            return NOTHING
        outputs = Outputs(
            tuple(self._commands),
            tuple(self._events),
            self.change,
            frozenset(self.parts),
            frozenset(self.signals),
            frozenset(self.errors),
            frozenset(self.reactions),
            self.system_state,
            self.task,
            self.task_changed,
            self.vehicle_changed,
            tuple(self._kept.values()),
            frozenset(self.devices),
        )
        self._kept = {}
        self._commands, self._events = [], []
        self.change, self.system_state = None, False
        self.parts, self.signals = set(), set()
        self.errors, self.reactions, self.devices = set(), set(), set()
        self.task, self.task_changed, self.vehicle_changed = None, False, False
        return outputs

    def _has_anything(self) -> bool:
        return bool(
            self._events
            or self._commands
            or self._kept
            or self.vehicle_changed
            or self.task_changed
            or self.parts
            or self.signals
            or self.errors
            or self.reactions
            or self.devices
            or self.system_state
            or self.change
            or self.task
        )

    def _append(self, event: Event, cause: int | None) -> int:
        recorded = RecordedEvent(self._next_event, self._at, cause, self._actor, event)
        self._next_event += 1
        self._events.append(recorded)
        return recorded.id
