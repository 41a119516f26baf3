"""The parts that all stream clients share: encoder, fan-out, limits and access."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

from fastapi import Depends, FastAPI
from fastapi.requests import HTTPConnection

from api.http.access import Access
from api.http.gate.refusals import Refusals
from api.streaming.encoder import StreamEncoder
from api.streaming.fan_out import FanOut
from service.supervisor import Supervisor

MAX_STRANGERS = 100
"""Clients that have not sent the token yet; counted apart, so that they take no places of others.
"""


class StreamServer:
    """Serves the stream of one supervisor to all of its clients."""

    def __init__(
        self, supervisor: Supervisor, max_clients: int, access: Access, refusals: Refusals
    ) -> None:
        self.supervisor = supervisor
        self.access = access
        self.refusals = refusals
        self.encoder = StreamEncoder(supervisor)
        self.fan_out = FanOut(supervisor, self.encoder)
        self.clients = 0
        self.strangers = 0
        """Connections that need the token and have not sent it yet."""
        self._max_clients = max_clients

    @property
    def is_full(self) -> bool:
        """Tell whether the maximum number of clients is reached."""
        return self.clients >= self._max_clients

    @property
    def has_many_strangers(self) -> bool:
        """Tell whether the maximum number of clients without a token is reached."""
        return self.strangers >= MAX_STRANGERS

    @contextmanager
    def count_client(self) -> Iterator[None]:
        """Count one more client while the context is open."""
        self.clients += 1
        try:
            yield
        finally:
            self.clients -= 1

    @contextmanager
    def count_stranger(self) -> Iterator[None]:
        """Count one more client without a token while the context is open."""
        self.strangers += 1
        try:
            yield
        finally:
            self.strangers -= 1


def stream_server(app: FastAPI) -> StreamServer:
    """Return the stream server of an application."""
    server: StreamServer = app.state.stream_server
    return server


# A coroutine, since the framework would call a plain function in a thread.
async def _server(connection: HTTPConnection) -> StreamServer:
    return stream_server(connection.app)


StreamServerDep = Annotated[StreamServer, Depends(_server)]
