"""The only input of the core: requests, reports of adapters, and deadlines.

After a stall of the event loop, deadlines wait until what has arrived meanwhile is taken in.
"""

import logging
from collections.abc import Callable

from domain.actor import Actor
from domain.errors import PilothouseError
from domain.inputs import Input, Readings, Restored, TimePassed
from domain.onboard import Onboard
from domain.outbox import Outputs
from domain.timebase import Instant
from service.catch_up import CatchUp
from service.clock import Clock
from service.pacing import Alarm
from service.refused_readings import RefusedReadings
from service.storage.journal import Step

log = logging.getLogger(__name__)


class Submitter:
    """Passes each input to the core at once, and the outputs to `carry_out`."""

    def __init__(
        self,
        onboard: Onboard,
        clock: Clock,
        carry_out: Callable[[Step], None],
        catch_up: CatchUp,
        refused: RefusedReadings,
    ) -> None:
        """Prepare.

        Args:
            onboard: The core.
            clock: Of the service.
            carry_out: Acts on what the core took and put out.
            catch_up: Tells whether deadlines wait.
            refused: Counts rejected readings of adapters, all of which hear ROS topics.
        """
        self._onboard = onboard
        self._clock = clock
        self._carry_out = carry_out
        self._catch_up = catch_up
        self._refused = refused
        self._alarm = Alarm(self._due, self.let_pass, clock)

    async def run(self) -> None:
        """Process deadlines exactly when they expire, until cancelled."""
        await self._alarm.run()

    def submit(self, given: Input) -> Outputs:
        """Pass an input to the core, and carry out its outputs.

        Raises:
            PilothouseError: The input is rejected; it changed nothing.
        """
        now = self._clock.now()
        return self._pass(given, now, is_late=self._catch_up.is_on(now))

    def begin(self, left: Restored) -> None:
        """Submit what an earlier run left, before anything that fell due since the core was made.

        A large robot takes seconds to make: the ids of events go on from what was left, and so none
        may come before it.
        """
        due, now = self._onboard.wake_at(), self._clock.now()
        self._pass(left, now, is_late=due is not None and due <= now)

    def _pass(self, given: Input, now: Instant, *, is_late: bool) -> Outputs:
        handle = self._onboard.take_in if is_late else self._onboard.handle
        try:
            outputs = handle(given, now)
        except PilothouseError:
            # Deadlines that expired before the rejected input are processed nevertheless.
            passed = TimePassed()
            self._carry_out(Step(now, passed, is_late, handle(passed, now)))
            raise
        finally:
            self._alarm.check()
        self._carry_out(Step(now, given, is_late, outputs))
        return outputs

    def deliver(self, given: Input) -> None:
        """Submit a report of an adapter; an invalid report must not end the adapter."""
        try:
            self.submit(given)
        except PilothouseError as error:
            self.note_rejected(given, error)

    def note_rejected(self, given: Input, error: PilothouseError) -> None:
        """Log a report of an adapter that was rejected; readings are counted, too."""
        if isinstance(given, Readings):
            self._refused.note(Actor(given.source, way="ros"), error.message)
        else:
            log.warning("rejected %s: %s", type(given).__name__, error)

    def let_pass(self) -> None:
        """Process the deadlines that have expired by now."""
        due, now = self._onboard.wake_at(), self._clock.now()
        if due is not None and due <= now and not self._catch_up.is_on(now):
            self._pass(TimePassed(), now, is_late=False)

    def _due(self) -> Instant | None:
        due, until = self._onboard.wake_at(), self._catch_up.until
        return due if due is None or until is None else max(due, until)
