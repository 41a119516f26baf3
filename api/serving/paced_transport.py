"""The transport as the protocol of a connection sees it."""

import asyncio
from collections.abc import Callable
from typing import Any


class PacedTransport(asyncio.Transport):
    """Passes all on but pauses of reading, which the intake and the protocol decide together."""

    def __init__(
        self,
        raw: asyncio.Transport,
        pause: Callable[[], None],
        resume: Callable[[], None],
        succeed: Callable[[asyncio.BaseProtocol], None],
    ) -> None:
        """Stand in for a transport.

        Args:
            raw: The transport.
            pause: Called when the protocol wants no more data.
            resume: Called when it wants data again.
            succeed: Called with the protocol that takes over.
        """
        super().__init__()
        self.raw = raw
        self._succeed = succeed
        # Bound here, so that they cost nothing.
        self.write = raw.write  # type: ignore[method-assign]
        self.is_closing = raw.is_closing  # type: ignore[method-assign]
        self.get_write_buffer_size = raw.get_write_buffer_size  # type: ignore[method-assign]
        self.pause_reading = pause  # type: ignore[method-assign]
        self.resume_reading = resume  # type: ignore[method-assign]

    def part(self) -> None:
        """Let go of the intake, since the connection has ended; a timer may still keep this."""
        self._succeed = self.pause_reading = self.resume_reading = _do_nothing  # type: ignore[method-assign]

    def get_extra_info(self, name: str, default: object = None) -> Any:  # noqa: ANN401
        """Return what the transport knows of the connection."""
        return self.raw.get_extra_info(name, default)

    def set_protocol(self, protocol: asyncio.BaseProtocol) -> None:
        """Let another protocol take over what follows."""
        self._succeed(protocol)

    def set_write_buffer_limits(self, high: int | None = None, low: int | None = None) -> None:
        """Set from which amount of unsent data on writing is paused."""
        self.raw.set_write_buffer_limits(high, low)

    def close(self) -> None:
        """Close once everything is sent."""
        self.raw.close()

    def abort(self) -> None:
        """Close at once."""
        self.raw.abort()


def _do_nothing(*_: object) -> None:
    pass
