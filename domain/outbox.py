"""Gathers what one input leads to: events with their cause, commands, and what looks different."""

from collections.abc import Mapping
from types import MappingProxyType

from domain.messages import ChangeId, Command, Event, Outputs, TaskId
from domain.system_model import PartName
from domain.timebase import Instant

NO_DATA: Mapping[str, object] = MappingProxyType({})


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
        self._events: list[Event] = []
        self._next_event = 1
        self._next_request = 1
        self._at: Instant = 0
        self._kind = ""
        self._actor = ""
        self._data: Mapping[str, object] = NO_DATA
        self._cause: int | None = None
        self._input_id: int | None = None

    def begin(
        self,
        at: Instant,
        kind: str,
        data: Mapping[str, object] = NO_DATA,
        actor: str = "",
        cause: int | None = None,
    ) -> None:
        """Begin an input; it becomes an event of `kind` when something follows from it."""
        self._at, self._kind, self._data = at, kind, data
        self._actor, self._cause = actor, cause
        self._input_id = None

    def record_input(self) -> int:
        """Record the input itself now, if it was not yet; return its id."""
        if self._input_id is None:
            self._input_id = self._append(self._kind, self._data, self._cause)
        return self._input_id

    def emit(self, kind: str, data: Mapping[str, object], cause: int | None = None) -> int:
        """Record what follows from the input, or from `cause` if that is nearer; return its id."""
        return self._append(kind, data, self.record_input() if cause is None else cause)

    def next_request(self) -> int:
        """Return a number for a command, never given before."""
        self._next_request += 1
        return self._next_request - 1

    def command(self, command: Command) -> None:
        """Send a command."""
        self._commands.append(command)

    def take(self) -> Outputs:
        """Return what was gathered since the last call."""
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

    def _append(self, kind: str, data: Mapping[str, object], cause: int | None) -> int:
        event = Event(self._next_event, self._at, kind, cause, self._actor, data)
        self._next_event += 1
        self._events.append(event)
        return event.id
