"""What a simulation tells: samples of the robot, and its events."""

from collections import Counter
from collections.abc import Iterator

from api.http.schemas.health import SystemStateJson
from api.http.schemas.parts import PartJson
from api.http.schemas.tasks import TaskJson, VehicleJson
from api.streaming.event_text import event_text
from api.streaming.members import Members
from domain.events.event import RecordedEvent
from domain.snapshot import PartView, TaskView
from service.event_log import EventReader, Gap
from service.supervisor import Supervisor
from service.worker import TooComplexError

MAX_EVENTS = 200_000
MAX_CHARACTERS = 200_000_000
"""Of all samples together: what a worker can hold and send."""


class Sampler:
    """Makes the text of samples and events; what did not change is not made again."""

    def __init__(self, supervisor: Supervisor) -> None:
        self._supervisor = supervisor
        clock = self._clock = supervisor.clock
        self._parts = Members[PartView](lambda view: PartJson.of(view, clock).model_dump_json())
        self._reader = EventReader(supervisor.events, supervisor.events.newest)
        self._left = MAX_CHARACTERS
        self.events: list[RecordedEvent] = []
        """All that happened since the begin."""

    def kept_sample(self, t_s: float, number: int) -> str:
        """Return the robot as it is now, as JSON that is kept.

        Args:
            t_s: Seconds since the begin.
            number: How many samples were taken before.

        Raises:
            TooComplexError: All of them together are too long.
        """
        text = self.sample(t_s, number)
        self._left -= len(text)
        if self._left < 0:
            how = f"its samples have more than {MAX_CHARACTERS // 10**6} MB; sample less often"
            raise TooComplexError(how)
        return text

    def sample(self, t_s: float, number: int) -> str:
        """Return the robot as it is now, as JSON; arguments as for `kept_sample`."""
        supervisor, clock = self._supervisor, self._clock
        core = supervisor.core
        driving = core.driving
        state = SystemStateJson.of(
            core.system_state(), number, clock.now(), supervisor.simulated, clock
        ).model_dump_json()
        task = driving.current_task
        task_text = "null" if task is None else self.task_text(task)
        vehicle = VehicleJson.of(driving.vehicle, driving.limits, clock).model_dump_json()
        return (
            f'{{"t_s":{t_s!r},"system_state":{state},"parts":{self._parts.text(core.parts())},'
            f'"task":{task_text},"vehicle":{vehicle}}}'
        )

    def task_text(self, task: TaskView) -> str:
        """Return a task as JSON."""
        return TaskJson.of(task, self._clock).model_dump_json()

    def counts(self) -> Counter[str]:
        """Return how many events of each kind there were."""
        return Counter(event.kind for event in self.events)

    def collect_events(self) -> None:
        """Take over what happened since the last call.

        Raises:
            TooComplexError: There are too many to be told.
        """
        for found in self._reader.take(_ALL):
            if isinstance(found, Gap):
                raise TooComplexError("too many events happen in it at once")
            self.events.append(found)
        if len(self.events) > MAX_EVENTS:
            raise TooComplexError(f"more than {MAX_EVENTS} events happen in it")

    def event_texts(self) -> Iterator[str]:
        """Yield all events as JSON."""
        epoch = self._supervisor.events.epoch
        return (event_text(event, epoch, self._clock) for event in self.events)


_ALL = 1_000_000
