"""A machine of the link that does what a test says, and a link that goes nowhere."""

import asyncio
from collections.abc import Callable

from domain.commands import LinkCommand, NodeCommand
from domain.computers import ComputerName
from domain.link.messages import Message, Told
from domain.link.outputs import NOTHING, LinkOutputs
from domain.timebase import Instant, seconds
from service.link.port import DeliverMessage, LinkCounts
from service.link.wire import encode

_FAR = seconds(1e6)


class ScriptedMachine:
    """Answers everything with what the test has set for it."""

    def __init__(self) -> None:
        self.heard: list[tuple[ComputerName, Message]] = []
        self.told: list[NodeCommand | LinkCommand] = []
        self.noted: list[Told] = []
        self.rang_at: list[Instant] = []
        self.due: Instant = _FAR
        self.answer: Callable[[], LinkOutputs] = lambda: NOTHING
        """What follows from a message or a command."""
        self.when_due: Callable[[], LinkOutputs] = lambda: NOTHING
        """What follows from time."""

    def hear(self, sender: ComputerName, message: Message, now: Instant, /) -> LinkOutputs:
        """Take a message."""
        self.heard.append((sender, message))
        return self.answer()

    def tell(self, command: NodeCommand | LinkCommand, now: Instant, /) -> LinkOutputs:
        """Take a command."""
        self.told.append(command)
        return self.answer()

    def note(self, told: Told, now: Instant, /) -> None:
        """Learn something, and let it be due at once."""
        self.noted.append(told)
        self.due = now

    def pass_time(self, now: Instant, /) -> LinkOutputs:
        """Be due no more."""
        self.rang_at.append(now)
        self.due = now + _FAR
        return self.when_due()

    def wake_at(self) -> Instant:
        """Return when the test lets something be due."""
        return self.due


class DeadEnd:
    """A link whose messages a test reads and writes."""

    def __init__(self) -> None:
        self.sent: list[tuple[ComputerName, bytes, bool]] = []
        self.deliver: DeliverMessage | None = None
        self.dropped: dict[ComputerName, int] = {}

    async def run(self, deliver: DeliverMessage) -> None:
        """Wait for the test."""
        self.deliver = deliver
        try:
            await asyncio.get_running_loop().create_future()
        finally:
            self.deliver = None

    def send(self, to: ComputerName, message: bytes, *, may_be_lost: bool) -> None:
        """Keep it."""
        self.sent.append((to, message, may_be_lost))

    def counts(self) -> LinkCounts:
        """Return what the test says was dropped."""
        return LinkCounts(self.dropped)

    def hear(self, sender: ComputerName, message: Message) -> None:
        """Let a message come."""
        assert self.deliver is not None
        self.deliver(sender, encode(message))
