"""A client that disconnects before it is answered, for tests that are the server themselves."""

import asyncio

from starlette.types import Message


class GoingClient:
    """Has sent a request, and is there until `gone` is set."""

    def __init__(self, body: bytes = b"") -> None:
        self.gone = asyncio.Event()
        self._said: list[Message] = [{"type": "http.request", "body": body, "more_body": False}]

    async def receive(self) -> Message:
        """Return the request, and once the client is gone that it is."""
        if self._said:
            return self._said.pop()
        await self.gone.wait()
        return {"type": "http.disconnect"}

    async def send(self, message: Message) -> None:
        """Take what the client does not read any more."""


class EndlessWork:
    """Goes on until it is cancelled."""

    is_given_up = False

    async def do(self, *_: object) -> None:
        """Do it, whatever it is called with."""
        try:
            await asyncio.Event().wait()
        finally:
            self.is_given_up = True
