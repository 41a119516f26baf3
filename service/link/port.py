"""The port of the link: carries messages between the computers of one robot, as bytes.

`tests/conformance/test_link.py` specifies what an adapter must do.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol, TypeAlias

from domain.computers import ComputerName

MAX_MESSAGE_BYTES = 2**20
"""Largest message; a longer one is not sent, and not taken in."""
MAX_MESSAGES_PER_S = 2_000
"""Messages of one computer that are taken in; of more, the rest is dropped and counted."""
MAX_BYTES_PER_S = 8 * 2**20
"""As `MAX_MESSAGES_PER_S`, for their length."""
MAX_BEATS_PER_S = 50
"""As `MAX_MESSAGES_PER_S`, for what may be lost: five times of what one computer sends."""

DeliverMessage: TypeAlias = Callable[[ComputerName, bytes], None]
"""Called on the event loop's thread with the sender, as the transport knows it, and its message."""


@dataclass(frozen=True, slots=True)
class LinkCounts:
    """What a link dropped since it was made."""

    received: Mapping[ComputerName, int] = field(default_factory=dict)
    """Of each sender: too much, too often or too long."""
    unknown: int = 0
    """From senders that are no computer of the robot."""
    sent: int = 0
    """Too long, for a computer that is not of the robot, or more than the connection carries."""


class Link(Protocol):
    """Carries messages to and from the other computers of the robot.

    Messages of one kind from one computer to another arrive in their order, or not at all; some may
    arrive late, also after the connection was cut, or twice.
    """

    async def run(self, deliver: DeliverMessage) -> None:
        """Deliver messages until cancelled; a connection that fails is tried again for ever."""
        ...

    def send(self, to: ComputerName, message: bytes, *, may_be_lost: bool) -> None:
        """Send a message, and return at once. Never raises for a computer that is not there.

        Called on the event loop's thread. Nothing is sent while the link does not run.

        Args:
            to: The computer that it is for.
            message: At most `MAX_MESSAGE_BYTES`; a longer one is dropped and counted.
            may_be_lost: It is worthless once a later one was sent: never delayed to send it again.
        """
        ...

    def counts(self) -> LinkCounts:
        """Return what was dropped since the link was made."""
        ...
