"""The service in virtual time: the live code, run as fast as it can be computed."""

import asyncio
from datetime import datetime

from domain.onboard import Onboard
from domain.simulation.robot import SimulatedRobot
from domain.timebase import Duration, Instant
from service.clock import since_epoch, to_datetime
from service.event_log import EventLog
from service.files.model_file import LoadedModel
from service.simulation.simulated import SimulatedBackend
from service.supervisor import Supervisor


class VirtualClock:
    """A `Clock` that is set; the caller that sets it also processes what is due until then."""

    def __init__(self, start: Instant, wall: datetime) -> None:
        """Start at `start`.

        Args:
            start: First time of the clock.
            wall: The wall time at `start`.
        """
        self._now = start
        self._offset: Duration = since_epoch(wall) - start

    def now(self) -> Instant:
        """Return the time that was set."""
        return self._now

    def set(self, now: Instant) -> None:
        """Set the time; it never goes back."""
        self._now = max(now, self._now)

    def wall_time(self, instant: Instant) -> datetime:
        """Return `instant` as UTC."""
        return to_datetime(instant + self._offset)

    def from_wall(self, moment: datetime) -> Instant:
        """Convert `moment` to this clock.

        Raises:
            InvalidValueError: `moment` has no offset from UTC.
        """
        return since_epoch(moment) - self._offset

    async def sleep_until(self, deadline: Instant) -> None:
        """Wait forever, unless `deadline` has passed: nothing waits in virtual time."""
        if deadline > self._now:
            await asyncio.get_running_loop().create_future()
        await asyncio.sleep(0)


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
