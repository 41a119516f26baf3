"""The output of a simulation: samples of the robot, and its events."""

from collections import Counter
from collections.abc import Iterator

from api.streaming.robot_encoder import RobotEncoder
from domain.events.event import RecordedEvent
from domain.snapshot import TaskView
from service.event_log import EventReader, Gap
from service.supervisor import Supervisor
from service.worker import TooComplexError

MAX_EVENTS = 200_000
MAX_CHARACTERS = 200_000_000
"""Of all samples together: as much as a worker can hold and send."""


class Sampler:
    """Encodes samples and events; unchanged views are not encoded again."""

    def __init__(self, supervisor: Supervisor) -> None:
        self._supervisor = supervisor
        self._encoder = RobotEncoder(supervisor)
        self._reader = EventReader(supervisor.events, supervisor.events.newest)
        self._left = MAX_CHARACTERS
        self.events: list[RecordedEvent] = []
        """All events since the start."""

    def kept_sample(self, t_s: float, number: int) -> str:
        """Return a sample of the robot now as JSON, and count its length.

        Args:
            t_s: Time since the start, s.
            number: Number of earlier samples.

        Raises:
            TooComplexError: All samples together are too long.
        """
        text = self.sample(t_s, number)
        self._left -= len(text)
        if self._left < 0:
            how = f"its samples have more than {MAX_CHARACTERS // 10**6} MB; sample less often"
            raise TooComplexError(how)
        return text

    def sample(self, t_s: float, number: int) -> str:
        """Return a sample of the robot now as JSON, with the members of a complete frame.

        Only `task` differs: it is the current task or null. Arguments are as for `kept_sample`.
        """
        supervisor, encoder = self._supervisor, self._encoder
        core, now = supervisor.core, supervisor.clock.now()
        driving = core.driving
        state = encoder.system_state(core.system_state(), number, now, supervisor.simulated)
        return (
            f'{{"t_s":{t_s!r},"system_state":{state},'
            f'"parts":{encoder.parts.text(core.parts())},'
            f'"signals":{encoder.signals.text(core.signals())},'
            f'"errors":{encoder.errors.text(core.open_errors())},'
            f'"reactions":{encoder.reactions.text(core.reactions())},'
            f'"task":{encoder.task(driving.current_task)},'
            f'"vehicle":{encoder.vehicle(driving.vehicle)},'
            f'"holds":{encoder.holds(driving.holds)},'
            f'"emergency_stop":{encoder.emergency_stop(core.emergency_stop())}}}'
        )

    def task_text(self, task: TaskView) -> str:
        """Return a task as JSON."""
        return self._encoder.task(task)

    def counts(self) -> Counter[str]:
        """Return the number of events of each kind."""
        return Counter(event.kind for event in self.events)

    def collect_events(self) -> None:
        """Add the events since the last call.

        Raises:
            TooComplexError: There are too many events.
        """
        for found in self._reader.take(_ALL):
            if isinstance(found, Gap):
                raise TooComplexError("too many events occur in it at once")
            self.events.append(found)
        if len(self.events) > MAX_EVENTS:
            raise TooComplexError(f"more than {MAX_EVENTS} events occur in it")

    def event_texts(self) -> Iterator[str]:
        """Yield all events as JSON."""
        return map(self._encoder.event, self.events)


_ALL = 1_000_000
