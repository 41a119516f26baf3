"""The shell round the core: hands it what happens, carries out what it says, publishes at 20 Hz.

It decides nothing. Whatever arrives is handed to the core at once (`submitter`), and when something
becomes due there, it is told so at that time; the tick only publishes (`frame_publisher`).
"""

from collections.abc import Callable, Sequence
from contextlib import suppress

from domain.actor import Actor
from domain.commands import PreemptGoal, SendGoal
from domain.errors import PilothouseError
from domain.findings import Finding
from domain.inputs import HoldRequest, Input
from domain.onboard import Onboard
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.paths.speed_profile import SpeedLimits
from domain.supervision import Supervision
from service.change_ends import ChangeEnds
from service.clock import Clock
from service.event_log import EventLog
from service.files.model_file import LoadedModel
from service.frame_publisher import FramePublisher
from service.node_incidents import log_node_incidents
from service.ports import RobotBackend
from service.readings import DirectReadings, ReadingInput, Submit
from service.running import run_forever
from service.submitter import Submitter


class Supervisor:
    """Owns the core and every task that feeds it; `run` ends only cancelled or broken."""

    def __init__(
        self,
        loaded: LoadedModel,
        onboard: Onboard,
        clock: Clock,
        backend: RobotBackend,
        readings: Callable[[Submit], ReadingInput] = DirectReadings,
        simulated: Sequence[str] = (),
        events: EventLog | None = None,
    ) -> None:
        """Put together what supervises a robot; nothing runs yet.

        Args:
            loaded: The model of the robot.
            onboard: Its core.
            clock: The present.
            backend: Its nodes, its vehicle and its own signals.
            readings: Makes the way in for readings from outside.
            simulated: What of the robot is not real.
            events: Where events are kept; None: a new log.
        """
        self.core: Supervision = onboard.core
        """For looking; what happens goes through `submit`."""
        self.clock = clock
        self.started_at = clock.now()
        """When this run of the service began, and with it its epoch."""
        self.simulated = tuple(simulated)
        self.events = events or EventLog()
        self.publisher = FramePublisher(onboard.core, clock, self.simulated)
        self.frames = self.publisher.frames
        self.change_ends = ChangeEnds(onboard.core, clock)
        self._loaded = loaded
        self._onboard = onboard
        self._backend = backend
        self._submitter = Submitter(onboard, clock, self._carry_out)
        self.submit: Callable[[Input], Outputs] = self._submitter.submit
        """Hands an input to the core; raises PilothouseError if it is refused."""
        self.deliver: Callable[[Input], None] = self._submitter.deliver
        """Takes what an adapter reports, and logs what is refused."""
        self.let_pass: Callable[[], None] = self._submitter.let_pass
        """Lets happen what time alone has made due."""
        self.readings = readings(self.submit)
        """Where readings from outside are handed in."""

    @property
    def model(self) -> SmhModel:
        """Return the model of the robot."""
        return self._loaded.model

    @property
    def model_text(self) -> str:
        """Return the model file as it was read."""
        return self._loaded.text

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Return what is odd about the model."""
        return self._loaded.warnings

    @property
    def speed_limits(self) -> SpeedLimits:
        """Return how hard the vehicle may be accelerated."""
        return self._onboard.navigation.settings.speed

    @property
    def epoch(self) -> str:
        """Return the name of this run of the service; event ids count from 1 in each."""
        return self.events.epoch

    async def run(self) -> None:
        """Run until cancelled; the first task that ends, ends them all.

        Raises:
            ExceptionGroup: Of a `TaskFailedError` that names the task and has what it raised as its
                cause.
        """
        await run_forever(
            {
                "robot": self._backend.run(self.deliver),
                "deadlines": self._submitter.run(),
                "log": log_node_incidents(self.events),
                "tick": self.publisher.run(),
            }
        )

    def stop_driving(self) -> None:
        """Hold the task and let the vehicle stand still, since the service ends."""
        # Refused only where there is no room for one more hold, and so it stands already.
        with suppress(PilothouseError):
            self.submit(HoldRequest("service", "the service ends", Actor("service")))

    def _carry_out(self, outputs: Outputs) -> None:
        """Act on the robot first, then tell."""
        for command in outputs.commands:
            # Goals stay on board; what is left is for nodes and the vehicle.
            if not isinstance(command, SendGoal | PreemptGoal):
                self._backend.send(command)
        self.publisher.note(outputs)
        for event in outputs.events:
            self.events.append(event)
        self.change_ends.note(outputs.events)
        if outputs.system_state:
            self.publisher.publish_change()
