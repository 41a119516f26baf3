"""The parts that all stream clients share: encoder, fan-out, limits and access."""

import asyncio
from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from http import HTTPStatus
from typing import Annotated

from fastapi import Depends, FastAPI
from fastapi.requests import HTTPConnection

from api.http.access import Access
from api.http.gate.refusals import Refusals
from api.streaming.encoder import StreamEncoder
from api.streaming.fan_out import FanOut
from service.clock import Clock
from service.history.event_history import EventHistory
from service.supervisor import Supervisor

MAX_STRANGERS = 100
"""Clients that have not sent the token yet; the oldest is closed for a new one, so that nobody can
keep others out by just connecting."""


class StreamServer:
    """Serves the stream of one supervisor to all of its clients."""

    def __init__(
        self,
        supervisor: Supervisor,
        max_clients: int,
        access: Access,
        refusals: Refusals,
        clock: Clock | None = None,
    ) -> None:
        """Begin without clients.

        Args:
            supervisor: Whose frames and events they get.
            max_clients: How many there may be.
            access: Whom it lets in.
            refusals: Counts those that it does not.
            clock: Of the connections; None: that of the supervisor.
        """
        self.supervisor = supervisor
        self.access = access
        self.refusals = refusals
        self.encoder = StreamEncoder(supervisor)
        self.history = EventHistory(supervisor.events, supervisor.journal, supervisor.clock)
        self.fan_out = FanOut(supervisor, self.encoder, self.history, clock or supervisor.clock)
        supervisor.publisher.owing_since = self.fan_out.owing_since
        self.clients = 0
        self._strangers: OrderedDict[asyncio.WriteTransport, None] = OrderedDict()
        """Connections that need the token and have not sent it yet, the oldest first."""
        self._max_clients = max_clients

    @property
    def is_full(self) -> bool:
        """Tell whether the maximum number of clients is reached."""
        return self.clients >= self._max_clients

    @contextmanager
    def count_client(self) -> Iterator[None]:
        """Count one more client while the context is open."""
        self.clients += 1
        try:
            yield
        finally:
            self.clients -= 1

    @contextmanager
    def host_stranger(self, transport: asyncio.WriteTransport) -> Iterator[None]:
        """Count a client without a token while the context is open; the oldest makes room for it.

        Args:
            transport: Of the client; closed if it is the one that makes room.
        """
        if len(self._strangers) >= MAX_STRANGERS:
            oldest, _ = self._strangers.popitem(last=False)
            self.refusals.note(HTTPStatus.SERVICE_UNAVAILABLE, "a client without a token")
            oldest.abort()
        self._strangers[transport] = None
        try:
            yield
        finally:
            self._strangers.pop(transport, None)


def stream_server(app: FastAPI) -> StreamServer:
    """Return the stream server of an application."""
    server: StreamServer = app.state.stream_server
    return server


# A coroutine, since the framework would call a plain function in a thread.
async def _server(connection: HTTPConnection) -> StreamServer:
    return stream_server(connection.app)


StreamServerDep = Annotated[StreamServer, Depends(_server)]
