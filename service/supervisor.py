"""The shell around the core: passes it every input, carries out its outputs, publishes at 20 Hz.

It decides nothing. An input is passed to the core at once, and a deadline of the core is processed
when it expires (`submitter`); the tick only publishes (`frame_publisher`).
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial

from domain.actor import SERVICE
from domain.commands import LinkCommand, PreemptGoal, ProcessCommand, SendGoal
from domain.computers import ComputerName, Connection
from domain.errors import PilothouseError
from domain.findings import Finding
from domain.inputs import HoldRequest, Input, Restored, ServiceStall
from domain.onboard import Onboard
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.paths.approach import ApproachLimits
from domain.supervision import Supervision
from domain.timebase import Duration, seconds
from service.catch_up import CatchUp
from service.change_ends import ChangeEnds
from service.checkpoint import checkpoint_of
from service.clock import Clock
from service.event_log import EventLog
from service.files.model_file import LoadedModel
from service.frame_publisher import PERIOD, FramePublisher
from service.keeper import NO_STORES, Checkpoint, Keeper, Stores, Taken
from service.live_faults import LiveFaults
from service.node_incidents import log_node_incidents
from service.ports import ComputersLink, NavigationBackend, ProcessRunner, RobotBackend
from service.readings import DirectReadings, ReadingInput, Submit
from service.refused_readings import RefusedReadings
from service.running import run_forever
from service.source_status import SourceStatus
from service.storage.journal import NOTHING_KEPT, Journal, Step, StorageStatus
from service.storage.trends.sampling import Sampling
from service.submitter import Submitter
from service.watchdog import hanging

STALL: Duration = seconds(0.25)
"""A tick that is later is told: the pose of a vehicle that reports every 0.05 s is too old then."""


_LARGE = 200
"""Parts of a robot whose state is written down in a fork; of fewer it takes some 2 ms."""


class Supervisor:
    """Owns the core and every task that feeds it; `run` ends only on cancellation or failure."""

    sources: Sequence[SourceStatus] = ()
    """How the sources of its signals are doing; set by who makes them."""

    navigation: NavigationBackend | None = None
    """The external controller, which the backend runs; set by who makes it. None: the trackers on
    board drive."""

    link: ComputersLink | None = None
    """The other computers of the robot, set by who makes it; None: there are none."""

    processes: ProcessRunner | None = None
    """Runs the processes of nodes, set by who makes it; None: there are none."""

    live_faults: LiveFaults | None = None
    """What is simulated here, set by who makes it; None: all is real, or elsewhere."""

    def __init__(
        self,
        loaded: LoadedModel,
        onboard: Onboard,
        clock: Clock,
        backend: RobotBackend,
        readings: Callable[[Submit], ReadingInput] = DirectReadings,
        simulated: Sequence[str] = (),
        events: EventLog | None = None,
        stores: Stores = NO_STORES,
    ) -> None:
        """Prepare; nothing runs yet.

        Args:
            loaded: The model of the robot.
            onboard: Its core.
            clock: Of the service.
            backend: Its nodes, its vehicle and its own signals.
            readings: Makes the input for external readings.
            simulated: The simulated pieces of the robot, as in `Frame`.
            events: The event log; None: a new one.
            stores: Keep what must survive a restart, and bring it back.
        """
        self.core: Supervision = onboard.core
        """Only for reading; inputs go through `submit`."""
        self.clock = clock
        self.started_at = clock.now()
        """Start of this run of the service, and of its epoch."""
        self.simulated = tuple(simulated)
        self.journal, self.trends = stores.journal, stores.trends
        """What keeps what must survive a restart, and the history of signals; None: nothing."""
        self._sampling = _sampling(stores, onboard.core)
        self.events = events or _event_log(self.journal)
        self.publisher = FramePublisher(onboard.core, clock, self.simulated)
        self.frames = self.publisher.frames
        self._catch_up = CatchUp(clock, self.publisher.tick_due)
        self.change_ends = ChangeEnds(onboard.core, clock, self._catch_up.wait)
        self._loaded = loaded
        self._onboard = onboard
        self._backend = backend
        self.refused_readings = RefusedReadings()
        self._submitter = Submitter(
            onboard, clock, self.carry_out, self._catch_up, self.refused_readings
        )
        self.publisher.on_tick.append(self._note_tick)
        self.readings = readings(self.submit)
        """The input for external readings."""
        self._keeper: Keeper | None = None
        self._keeper = self._restore(stores)

    def _restore(self, stores: Stores) -> Keeper | None:
        """Bring back what an earlier run left; return who keeps it from now on."""
        if stores.journal is None:
            return None
        self._submitter.begin(stores.journal.found.restored)
        version = stores.journal.boot.version
        checkpoint = Checkpoint(
            partial(checkpoint_of, self._onboard, version), len(self.model.parts) > _LARGE
        )
        return Keeper(stores.journal, self.submit, self.clock, stores.memories, checkpoint)

    @property
    def model(self) -> SmhModel:
        """Return the model of the robot."""
        return self._loaded.model

    @property
    def model_name(self) -> str:
        """Return the name of the model file; empty: not known."""
        return self._loaded.name

    @property
    def model_text(self) -> str:
        """Return the model file as it was read."""
        return self._loaded.text

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Return the warnings about the model."""
        return self._loaded.warnings

    @property
    def approach_limits(self) -> ApproachLimits:
        """Return what the vehicle can do, and from how far it approaches a path."""
        return self._onboard.navigation.approach_limits

    def connection(self, computer: ComputerName) -> Connection:
        """Return how the connection to another computer is doing."""
        return Connection() if self.link is None else self.link.connection(computer)

    @property
    def epoch(self) -> str:
        """Return the name of this run of the service."""
        return self.events.epoch

    @property
    def boot(self) -> int:
        """Return the number of this run, from 1; always 1 where nothing is kept."""
        return 1 if self.journal is None else self.journal.found.restored.boot

    async def run(self) -> None:
        """Run until cancelled; the first task that ends cancels the others.

        Raises:
            ExceptionGroup: Of a `TaskFailedError` that names the task; its cause is what the task
                raised.
        """
        work = {
            "robot": self._backend.run(self.deliver_of_here),
            "deadlines": self._submitter.run(),
            "log": log_node_incidents(self.events),
            "tick": self.publisher.run(),
        }
        if self.link is not None:
            self._tell_stops(self.link)
            work["link"] = self.link.run(self.deliver)
        if self.processes is not None:
            work["processes"] = self.processes.run(self.deliver)
        if self._keeper is not None:
            work["keeper"] = self._keeper.run()
        await run_forever(work)

    def _tell_stops(self, link: ComputersLink) -> None:
        """Let the link know which stops are engaged here before it says that there is none."""
        if self.journal is None:
            # Nothing was restored: the core does not know yet how this run is named.
            self.submit(Restored(run=self.epoch, next_event=self.core.next_event))
        link.send(self.core.stops_to_tell())

    def submit(self, given: Input) -> Outputs:
        """Pass an input to the core.

        Raises:
            PilothouseError: The input is rejected, or a device's to say; it changed nothing.
        """
        self.core.check_said_here(given)
        return self._submitter.submit(given)

    def deliver(self, given: Input) -> None:
        """Submit a report of an adapter, and log it if it is rejected."""
        self._submitter.deliver(given)

    def deliver_of_here(self, given: Input) -> None:
        """As `deliver`, of an adapter that must not speak for a device, as only the link does."""
        try:
            self.core.check_said_here(given)
        except PilothouseError as error:
            self._submitter.note_rejected(given, error)
            return
        self.deliver(given)

    def let_pass(self) -> None:
        """Process the deadlines that have expired by now."""
        self._submitter.let_pass()

    def carry_out(self, step: Step) -> None:
        """Send commands to the robot first, then note what happened, then publish.

        Args:
            step: What the core took; of a recorded robot, whoever replays it passes it here.
        """
        outputs = step.outputs
        for command in outputs.commands:
            if isinstance(command, LinkCommand):
                if self.link is not None:
                    self.link.send(command)
            elif isinstance(command, ProcessCommand):
                if self.processes is not None:
                    self.processes.send(command)
            elif isinstance(command, SendGoal | PreemptGoal):
                # Only with an external controller do goals leave the core.
                if self.navigation is not None:
                    self.navigation.send(command)
            else:
                self._backend.send(command)
        if self.link is not None:
            self.link.note(step.given)
        if self._keeper is not None:
            self._keeper.keep_with_step(step.at)
        if self.journal is not None:
            self.journal.note(step)
        if self._sampling is not None and outputs.signals:
            self._sampling.note(outputs.signals, step.at)
        self.publisher.note(outputs)
        self.events.append(*outputs.events)
        self.change_ends.note(outputs.events)
        if outputs.system_state:
            self.publisher.publish_change()

    async def request(self, given: Input, *, volatile: bool = False) -> Taken:
        """Submit a request whose outcome is kept, as `Keeper.request` does.

        Raises:
            PilothouseError: The request is rejected; nothing was done.
        """
        if self._keeper is None:
            return Taken(self.submit(given), is_durable=False)
        first = self.core.may_loosen(given) and not volatile
        return await self._keeper.request(given, first=first)

    @property
    def storage(self) -> StorageStatus:
        """Return how storage is doing."""
        return NOTHING_KEPT if self.journal is None else self.journal.status()

    def hanging(self) -> str | None:
        """Return what of the supervision hangs, in words; None: all goes on."""
        publisher = self.publisher
        return hanging(
            self._onboard.wake_at(),
            publisher.last_tick_at,
            publisher.published_at,
            publisher.owing_since(),
            self.clock.now(),
        )

    def stop_driving(self) -> None:
        """Hold the task and stop the vehicle, since the service ends."""
        # Rejected only if the maximum of holds is reached, and then the vehicle is held already.
        with suppress(PilothouseError):
            self.submit(HoldRequest("service", "the service ends", SERVICE))

    def _note_tick(self, since_s: float) -> None:
        """Let deadlines wait after a tick that was late, and tell of one that was very late.

        The history of the signals is written every few seconds, which it learns here.
        """
        self._catch_up.note_tick(self.clock.now())
        if self.trends is not None:
            self.trends.pass_time(self.clock.now())
        late = seconds(since_s) - PERIOD
        if late > STALL:
            self.submit(ServiceStall(late))


def _event_log(journal: Journal | None) -> EventLog:
    """Return an empty log that goes on after the events of earlier runs."""
    if journal is None:
        return EventLog()
    found = journal.found
    return EventLog(
        epoch=journal.boot.epoch,
        before=found.restored.next_event - 1,
        earlier=found.epochs,
    )


def _sampling(stores: Stores, core: Supervision) -> Sampling | None:
    return None if stores.trends is None else Sampling(stores.trends, core.signal)
