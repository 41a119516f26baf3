"""Runs the machine of one end of the link in real time: messages in and out, inputs to the core."""

import asyncio
import logging
from collections import deque
from dataclasses import replace
from typing import Protocol, cast

from domain.commands import LinkCommand, NodeCommand
from domain.computers import ComputerName, Connection
from domain.inputs import Input, ReportBacklog
from domain.link.messages import Beat, Message
from domain.link.outputs import LinkOutputs
from domain.timebase import Instant
from service.clock import Clock
from service.codec.errors import CodecError
from service.link.port import Link
from service.link.status import LinkStatus
from service.link.wire import decode, encode_in_pieces
from service.pacing import AT_ONCE, Alarm
from service.ports import BackendMessage, Deliver

log = logging.getLogger(__name__)

_SOURCE = "link"

MAX_WAITING = 50_000
"""Inputs that wait for the core, from which on only beats are heard. What a report that is left out
would have told is in the next complete one, a second later."""


class Machine(Protocol):
    """What decides at one end of the link: `SupervisorLink` or `DeviceLink`."""

    def hear(self, sender: ComputerName, message: Message, now: Instant, /) -> LinkOutputs:
        """Take a message of another computer."""
        ...

    def tell(self, command: NodeCommand | LinkCommand, now: Instant, /) -> LinkOutputs:
        """Take a command of the core."""
        ...

    def pass_time(self, now: Instant, /) -> LinkOutputs:
        """Do all that is due up to `now`."""
        ...

    def wake_at(self) -> Instant:
        """Return when something is due next; after `pass_time(now)` this is later than `now`."""
        ...


class LinkEnd:
    """One end of the link; subclasses say which machine decides."""

    def __init__(self, machine: Machine, link: Link, clock: Clock, status: LinkStatus) -> None:
        """Prepare; nothing is sent before `run`.

        Args:
            machine: Decides what is sent, and what the core learns.
            link: Carries the messages.
            clock: Of the service.
            status: Measures the connections.
        """
        self._status = status
        self._machine = machine
        self._link = link
        self._clock = clock
        self._waiting = deque[Input]()
        """Inputs that the core has not got yet."""
        self._delivered: Instant = clock.now()
        """Up to when all that arrived was delivered."""
        self._is_behind = False
        self._deliver: Deliver | None = None
        self._alarm = Alarm(self._due, self._ring, clock)

    async def run(self, deliver: Deliver) -> None:
        """Exchange messages with the other computers, and deliver what follows, until cancelled."""
        self._deliver = deliver
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(self._link.run(self._hear), name="messages of the link")
            await self._alarm.run()

    def send(self, command: NodeCommand | LinkCommand, /) -> None:
        """Send a command to another computer, and return at once.

        What the core is to learn of it comes in a later turn of the loop: it is called by the core.
        """
        self._carry_out(self._machine.tell(command, self._clock.now()))

    def connection(self, computer: ComputerName) -> Connection:
        """Return how the connection to another computer is doing."""
        measured = self._status.of(computer, self._clock.now())
        dropped = self._link.counts().received.get(computer, 0)
        return replace(measured, dropped=measured.dropped + dropped)

    def _hear(self, sender: ComputerName, text: bytes) -> None:
        try:
            message = decode(text)
        except CodecError as error:
            self._status.note_left_out(sender)
            log.debug("%s sent what is no message: %s", sender, error)
            return
        if len(self._waiting) >= MAX_WAITING and not isinstance(message, Beat):
            self._status.note_left_out(sender)
            return
        now = self._clock.now()
        self._status.note_heard(sender, message, now)
        self._carry_out(self._machine.hear(sender, message, now))

    def _carry_out(self, outputs: LinkOutputs) -> None:
        now = self._clock.now()
        for to, message in outputs.sendings:
            try:
                texts = encode_in_pieces(message)
            except CodecError as error:
                log.warning("a message for %s is not sent: %s", to, error)
                continue
            self._status.note_sent(to, message, now)
            for text in texts:
                self._link.send(to, text, may_be_lost=isinstance(message, Beat))
        self._waiting.extend(outputs.inputs)
        self._alarm.check()

    def _due(self) -> Instant:
        return self._delivered if self._waiting else self._machine.wake_at()

    def _ring(self) -> None:
        """Do what is due, and deliver some of what waits, so that other tasks keep running."""
        now = self._clock.now()
        if self._machine.wake_at() <= now:
            self._carry_out(self._machine.pass_time(now))
        if not self._is_behind and len(self._waiting) > AT_ONCE:
            self._is_behind = True
            self._pass_on(ReportBacklog(_SOURCE, self._delivered))
        for _ in range(min(AT_ONCE, len(self._waiting))):
            self._pass_on(self._waiting.popleft())
        if not self._waiting:
            self._delivered = now
            if self._is_behind:
                self._is_behind = False
                self._pass_on(ReportBacklog(_SOURCE, None))

    def _pass_on(self, given: Input) -> None:
        assert self._deliver is not None
        # A machine gives nothing but what an adapter may deliver.
        self._deliver(cast("BackendMessage", given))
