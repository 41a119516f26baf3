"""All rosbridge clients of one service, and the task that runs while there are any."""

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
from service.ros.interface.settings import InterfaceSettings
from service.supervisor import Supervisor
from service.worker import Jobs

log = logging.getLogger(__name__)

MAX_CLIENTS = 50
"""Each has its own writer and subscriptions; many clients should use `WS /ws` instead."""


class RosbridgeClients:
    """Owns the task that publishes messages to the clients."""

    def __init__(self, make_bridge: Callable[[], Bridge], lobby: StreamServer) -> None:
        """Start without clients.

        Args:
            make_bridge: Makes the bridge that all clients share. Called in a thread for the first
                client, since with thousands of parts it takes longer than a tick may be late.
            lobby: Decides who has access, and counts unauthenticated clients together with those of
                the stream.
        """
        self.lobby = lobby
        self._make_bridge = make_bridge
        self._making: asyncio.Task[Bridge] | None = None
        self._transports: set[asyncio.WriteTransport] = set()
        self._task: asyncio.Task[None] | None = None

    @property
    def clients(self) -> int:
        """Return the number of clients."""
        return len(self._transports)

    @property
    def is_full(self) -> bool:
        """Tell whether the maximum number of clients is reached."""
        return self.clients >= MAX_CLIENTS

    async def bridge(self) -> Bridge:
        """Return the bridge that all clients share."""
        if self._making is None:
            making = asyncio.to_thread(self._make_bridge)
            self._making = asyncio.create_task(making, name="rosbridge begins")
        # Later clients need it too, even if this one disconnects.
        return await asyncio.shield(self._making)

    @asynccontextmanager
    async def serve(self, transport: asyncio.WriteTransport) -> AsyncIterator[Bridge]:
        """Count a client, and publish messages, while the context is open.

        Args:
            transport: Of the client; it is closed if publishing fails.
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
        """Disconnect all clients if the task failed: a silent connection would mislead them."""
        if task.cancelled():
            return
        log.critical("rosbridge failed", exc_info=task.exception())
        self._task = None
        for transport in tuple(self._transports):
            transport.abort()


def make_rosbridge_clients(
    supervisor: Supervisor,
    settings: InterfaceSettings,
    jobs: Jobs,
    calls_per_s: int,
    lobby: StreamServer,
) -> RosbridgeClients:
    """Return the rosbridge clients of a robot.

    Args:
        supervisor: Of the robot.
        settings: What is offered to them.
        jobs: Do what would keep the event loop.
        calls_per_s: Service calls per second that one client address may make.
        lobby: As for `RosbridgeClients`.
    """
    return RosbridgeClients(partial(_make_bridge, supervisor, settings, jobs, calls_per_s), lobby)


def rosbridge_clients(app: FastAPI) -> RosbridgeClients:
    """Return the clients of rosbridge of an application."""
    clients: RosbridgeClients = app.state.rosbridge_clients
    return clients


def _make_bridge(
    supervisor: Supervisor, settings: InterfaceSettings, jobs: Jobs, calls_per_s: int
) -> Bridge:
    return Bridge(
        RosInterface(supervisor, settings, jobs),
        supervisor.frames,
        supervisor.clock,
        calls_per_s,
        supervisor.refused_readings,
    )


# A coroutine, since the framework would call a plain function in a thread.
async def _clients(connection: HTTPConnection) -> RosbridgeClients:
    return rosbridge_clients(connection.app)


RosbridgeClientsDep = Annotated[RosbridgeClients, Depends(_clients)]
