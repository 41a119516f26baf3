"""The way into the core: what somebody asks, what an adapter reports, and what time makes due."""

import logging
from collections.abc import Callable

from domain.errors import PilothouseError
from domain.inputs import Input, TimePassed
from domain.onboard import Onboard
from domain.outbox import Outputs
from service.clock import Clock
from service.pacing import Alarm

log = logging.getLogger(__name__)


class Submitter:
    """Hands each input to the core at once, and what follows from it to `carry_out`."""

    def __init__(
        self, onboard: Onboard, clock: Clock, carry_out: Callable[[Outputs], None]
    ) -> None:
        self._onboard = onboard
        self._clock = clock
        self._carry_out = carry_out
        self._alarm = Alarm(onboard.wake_at, self.let_pass, clock)

    async def run(self) -> None:
        """Let happen what time alone makes due, at exactly its time, until cancelled."""
        await self._alarm.run()

    def submit(self, given: Input) -> Outputs:
        """Hand an input to the core and carry out what follows.

        Raises:
            PilothouseError: It is refused; nothing was changed by it.
        """
        now = self._clock.now()
        try:
            outputs = self._onboard.handle(given, now)
        except PilothouseError:
            # What was due before it is due all the same.
            self._carry_out(self._onboard.handle(TimePassed(), now))
            raise
        finally:
            self._alarm.check()
        self._carry_out(outputs)
        return outputs

    def deliver(self, given: Input) -> None:
        """Take what an adapter reports; one bad report must not end the adapter."""
        try:
            self.submit(given)
        except PilothouseError as error:
            log.warning("refused %s: %s", type(given).__name__, error)

    def let_pass(self) -> None:
        """Let happen what time alone has made due."""
        due = self._onboard.wake_at()
        if due is not None and due <= self._clock.now():
            self.submit(TimePassed())
