"""All clients of rosbridge of one service, and what runs as long as there are any."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial
from typing import Annotated

from fastapi import Depends, FastAPI
from fastapi.requests import HTTPConnection

from api.rosbridge.bridge import Bridge
from api.streaming.stream_server import StreamServer
from service.ros.interface.interface import RosInterface
from service.supervisor import Supervisor

log = logging.getLogger(__name__)

MAX_CLIENTS = 50
"""Each has a writer and subscriptions of its own; the stream is for the many."""


class RosbridgeClients:
    """Owns the task that makes messages of what happens."""

    def __init__(self, make_bridge: Callable[[], Bridge], lobby: StreamServer) -> None:
        """Begin without clients.

        Args:
            make_bridge: Makes what all clients share, in a thread, when it is wanted first: with
                thousands of parts it takes longer than a tick may wait.
            lobby: Knows who may come in; who has not given the token is counted there, together
                with strangers of the stream.
        """
        self.lobby = lobby
        self._make_bridge = make_bridge
        self._making: asyncio.Task[Bridge] | None = None
        self._transports: set[asyncio.WriteTransport] = set()
        self._task: asyncio.Task[None] | None = None

    @property
    def clients(self) -> int:
        """Return how many there are."""
        return len(self._transports)

    @property
    def is_full(self) -> bool:
        """Tell whether the next client is one too many."""
        return self.clients >= MAX_CLIENTS

    async def bridge(self) -> Bridge:
        """Return what all clients share."""
        if self._making is None:
            making = asyncio.to_thread(self._make_bridge)
            self._making = asyncio.create_task(making, name="rosbridge begins")
        # The next one wants it too, although this one may go.
        return await asyncio.shield(self._making)

    @asynccontextmanager
    async def serve(self, transport: asyncio.WriteTransport) -> AsyncIterator[Bridge]:
        """Make messages for a client as long as the context lasts.

        Args:
            transport: Of the client; it is cut off when no more messages can be made.
        """
        self._transports.add(transport)
        try:
            bridge = await self.bridge()
            if self._task is None:
                self._task = asyncio.create_task(bridge.interface.run(), name="rosbridge")
                self._task.add_done_callback(self._ended)
            yield bridge
        finally:
            self._transports.discard(transport)
            if not self._transports and self._task is not None:
                self._task.cancel()
                self._task = None

    def _ended(self, task: asyncio.Task[None]) -> None:
        """Cut all clients off when the task has failed: a silent connection would deceive them."""
        if task.cancelled():
            return
        log.critical("rosbridge failed", exc_info=task.exception())
        self._task = None
        for transport in tuple(self._transports):
            transport.abort()


def make_rosbridge_clients(
    supervisor: Supervisor, calls_per_s: int, lobby: StreamServer
) -> RosbridgeClients:
    """Return what takes clients to the ROS interface of a robot.

    Args:
        supervisor: What is served.
        calls_per_s: Calls of services that one client address may make.
        lobby: As of `RosbridgeClients`.
    """
    return RosbridgeClients(partial(_make_bridge, supervisor, calls_per_s), lobby)


def rosbridge_clients(app: FastAPI) -> RosbridgeClients:
    """Return the clients of rosbridge of an application."""
    clients: RosbridgeClients = app.state.rosbridge_clients
    return clients


def _make_bridge(supervisor: Supervisor, calls_per_s: int) -> Bridge:
    return Bridge(RosInterface(supervisor), supervisor.frames, supervisor.clock, calls_per_s)


# A coroutine, since the framework would call a plain function in a thread.
async def _clients(connection: HTTPConnection) -> RosbridgeClients:
    return rosbridge_clients(connection.app)


RosbridgeClientsDep = Annotated[RosbridgeClients, Depends(_clients)]
