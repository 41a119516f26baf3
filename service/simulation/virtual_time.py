"""The service in virtual time: the live code, run as fast as it can be computed."""

from domain.onboard import Onboard
from domain.simulation.robot import SimulatedRobot
from domain.timebase import Instant
from service.event_log import EventLog
from service.files.model_file import LoadedModel
from service.simulation.simulated import SimulatedBackend
from service.supervisor import Supervisor
from service.virtual_clock import VirtualClock


class VirtualService:
    """Supervisor and simulated robot on a clock that only this object sets; no asyncio task runs.

    At one instant, deadlines on board come first, then nodes, signals and vehicle, as live.
    """

    def __init__(
        self,
        loaded: LoadedModel,
        onboard: Onboard,
        robot: SimulatedRobot,
        clock: VirtualClock,
        events: EventLog,
    ) -> None:
        self.clock = clock
        self.onboard = onboard
        self.robot = robot
        self.backend = SimulatedBackend(robot, clock)
        self.supervisor = Supervisor(
            loaded, onboard, clock, self.backend, self.backend.readings, robot.what, events
        )
        self.supervisor.live_faults = self.backend
        # A request that waits for the end of a change is answered at once.
        self.supervisor.change_ends.stop()

    def advance_to(self, end: Instant) -> None:
        """Advance the time to `end`, and process everything that is due up to and including it."""
        while (due := self._due()) <= end:
            self.clock.set(due)
            for message in self.robot.advance(self.clock.now()):
                self.supervisor.deliver(message)
            self.supervisor.let_pass()
        self.clock.set(end)

    def _due(self) -> Instant:
        robot, onboard = self.robot.wake_at(), self.onboard.wake_at()
        return robot if onboard is None else min(robot, onboard)
