"""What all clients of the stream share: the encoder, their number, and what became of them."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

from fastapi import Depends, FastAPI
from fastapi.requests import HTTPConnection

from api.streaming.encoder import StreamEncoder
from service.supervisor import Supervisor

MAX_CLIENTS = 200


class StreamHub:
    """The clients of one service."""

    def __init__(self, supervisor: Supervisor) -> None:
        self.supervisor = supervisor
        self.encoder = StreamEncoder(supervisor)
        self.clients = 0
        self.dropped = 0
        """Clients that were cut off because they read too slowly."""
        self.skipped = 0
        """Frames that clients missed."""

    @property
    def is_full(self) -> bool:
        """Tell whether the next client is one too many."""
        return self.clients >= MAX_CLIENTS

    @contextmanager
    def count_client(self) -> Iterator[None]:
        """Count one more client as long as the context lasts."""
        self.clients += 1
        try:
            yield
        finally:
            self.clients -= 1


def stream_hub(app: FastAPI) -> StreamHub:
    """Return the hub of an application; the first who asks makes it."""
    hub = getattr(app.state, "stream_hub", None)
    if not isinstance(hub, StreamHub):
        hub = app.state.stream_hub = StreamHub(app.state.supervisor)
    return hub


# A coroutine, since the framework would call a plain function in a thread.
async def _hub(connection: HTTPConnection) -> StreamHub:
    return stream_hub(connection.app)


StreamHubDep = Annotated[StreamHub, Depends(_hub)]
