"""The only input of the core: requests, reports of adapters, and deadlines."""

import logging
from collections.abc import Callable

from domain.actor import Actor
from domain.errors import PilothouseError
from domain.inputs import Input, Readings, TimePassed
from domain.onboard import Onboard
from domain.outbox import Outputs
from service.clock import Clock
from service.pacing import Alarm
from service.refused_readings import RefusedReadings

log = logging.getLogger(__name__)


class Submitter:
    """Passes each input to the core at once, and the outputs to `carry_out`."""

    def __init__(
        self,
        onboard: Onboard,
        clock: Clock,
        carry_out: Callable[[Outputs], None],
        refused: RefusedReadings,
    ) -> None:
        """Prepare.

        Args:
            onboard: The core.
            clock: Of the service.
            carry_out: Acts on the outputs of the core.
            refused: Counts rejected readings of adapters, all of which hear ROS topics.
        """
        self._onboard = onboard
        self._clock = clock
        self._carry_out = carry_out
        self._refused = refused
        self._alarm = Alarm(onboard.wake_at, self.let_pass, clock)

    async def run(self) -> None:
        """Process deadlines exactly when they expire, until cancelled."""
        await self._alarm.run()

    def submit(self, given: Input) -> Outputs:
        """Pass an input to the core, and carry out its outputs.

        Raises:
            PilothouseError: The input is rejected; it changed nothing.
        """
        now = self._clock.now()
        try:
            outputs = self._onboard.handle(given, now)
        except PilothouseError:
            # Deadlines that expired before the rejected input are processed nevertheless.
            self._carry_out(self._onboard.handle(TimePassed(), now))
            raise
        finally:
            self._alarm.check()
        self._carry_out(outputs)
        return outputs

    def deliver(self, given: Input) -> None:
        """Submit a report of an adapter; an invalid report must not end the adapter."""
        try:
            self.submit(given)
        except PilothouseError as error:
            if isinstance(given, Readings):
                self._refused.note(Actor(given.source, way="ros"), error.message)
            else:
                log.warning("rejected %s: %s", type(given).__name__, error)

    def let_pass(self) -> None:
        """Process the deadlines that have expired by now."""
        due = self._onboard.wake_at()
        if due is not None and due <= self._clock.now():
            self.submit(TimePassed())
