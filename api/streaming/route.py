"""`WS /ws`: frames and events to each client at its own pace, and readings from it.

What is published is written by `api.streaming.fan_out`, to all clients at once. Here each client
has one coroutine that lets it in and hears what it says.
"""

import asyncio
import logging
from collections.abc import Mapping
from contextlib import suppress
from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from api.http.access import UnauthorizedError
from api.http.route_policy import Permission, policy
from api.http.schemas.stream import AuthMessage, ResyncMessage
from api.streaming.client_input import read_client_message, read_stream_query
from api.streaming.stream_client import StreamClient
from api.streaming.stream_server import StreamServer, StreamServerDep
from api.streaming.websocket_frames import connection_of, text_frame
from domain.actor import Actor
from domain.errors import PilothouseError

router = APIRouter()
log = logging.getLogger(__name__)

AUTH_TIMEOUT_S = 5.0
"""For a client to say who it is."""
ANSWER_TIMEOUT_S = 4.5
"""For a client to take the answer to what it said."""
_CLOSE_TIMEOUT_S = 1.0

_POLICY_VIOLATION = 1008
_TRY_AGAIN_LATER = 1013
_UNAUTHORIZED = 4401


@router.websocket("/ws")
@policy(Permission.OBSERVE)
async def stream(socket: WebSocket, server: StreamServerDep) -> None:
    """Serve one client until it goes, is too slow, or the service ends.

    What is wrong with the address is told after the handshake, as a `problem` frame and with close
    code 1008, since a browser does not show a page why its handshake was refused.
    """
    await socket.accept()
    client = _Client(socket, server)
    with suppress(_GoneError):
        if not await client.is_let_in():
            return
        if server.is_full:
            await client.send_away()
            return
        with server.count_client():
            await client.serve()


class _GoneError(Exception):
    """The client is not there any more."""


class _Client:
    """One client, as the interface hears it."""

    def __init__(self, socket: WebSocket, server: StreamServer) -> None:
        self._socket = socket
        self._connection = connection_of(socket.scope)
        self._server = server
        self._address = socket.client.host if socket.client else "unknown"

    async def is_let_in(self) -> bool:
        """Ask for the token, where one is needed and the handshake did not hold it.

        Whoever does not give it is told so, and the connection is closed.

        Raises:
            _GoneError: The client went.
        """
        server = self._server
        if server.access.accepts_header(self._socket.headers):
            return True
        if server.has_many_strangers:
            await self.send_away()
            return False
        try:
            with server.count_stranger():
                await self._hear_token()
        except UnauthorizedError as error:
            server.refusals.note(HTTPStatus.UNAUTHORIZED, self._address)
            await self._refuse(error, _UNAUTHORIZED)
            return False
        return True

    async def send_away(self) -> None:
        """Close, since there are too many already."""
        await self._close(_TRY_AGAIN_LATER, "too many clients")

    async def serve(self) -> None:
        """Write to the client and hear it until it goes.

        Raises:
            _GoneError: It went.
        """
        try:
            query = read_stream_query(self._socket.query_params)
        except PilothouseError as error:
            await self._refuse(error, _POLICY_VIOLATION)
            return
        if self._connection.transport.is_closing():
            raise _GoneError
        encoder = self._server.encoder
        self._connection.transport.write(text_frame(encoder.hello(query.topics)))
        complete = self._server.supervisor.frames.complete()
        if complete is not None:
            await encoder.prepare(complete, query.topics)
        with self._server.fan_out.serve(self._connection, query, self._address) as client:
            await self._listen(client)

    async def _hear_token(self) -> None:
        """Take the first message.

        Raises:
            UnauthorizedError: It is not the right token, or does not come soon.
        """
        try:
            async with asyncio.timeout(AUTH_TIMEOUT_S):
                message = await self._receive()
        except TimeoutError as error:
            raise UnauthorizedError(f"no token came within {AUTH_TIMEOUT_S:g} s") from error
        try:
            said = read_client_message(message)
        except PilothouseError:
            said = None
        if not isinstance(said, AuthMessage):
            raise UnauthorizedError("the first message has to be the token")
        if not self._server.access.accepts(said.token):
            raise UnauthorizedError("this is not the token of the service")

    async def _listen(self, client: StreamClient) -> None:
        """Take one message after the other; the next waits in the client until this one is done."""
        while True:
            message = await self._receive()
            try:
                self._take(message, client)
            except PilothouseError as error:
                await self._answer(error)
            # Messages that came together are all there at once: others get their turn in between.
            await asyncio.sleep(0)

    async def _receive(self) -> Mapping[str, Any]:
        message = await self._socket.receive()
        if message["type"] == "websocket.disconnect":
            raise _GoneError
        return message

    def _take(self, message: Mapping[str, Any], client: StreamClient) -> None:
        supervisor = self._server.supervisor
        given = read_client_message(message)
        if isinstance(given, AuthMessage):
            # A page that still has a token sends it, whether or not it is needed.
            return
        if isinstance(given, ResyncMessage):
            self._server.fan_out.resync(client)
            return
        reading = given.reading(given.signal, supervisor.clock)
        actor = Actor(way="websocket", address=self._address)
        supervisor.readings.submit([reading], given.source, actor)

    async def _answer(self, error: PilothouseError) -> None:
        """Say what is wrong, once the client has taken most of what was written before."""
        try:
            async with asyncio.timeout(ANSWER_TIMEOUT_S):
                await self._socket.send_text(self._server.encoder.problem(error))
        except TimeoutError as late:
            self._server.fan_out.drop(self._connection.transport, self._address)
            raise _GoneError from late
        except (WebSocketDisconnect, RuntimeError) as gone:
            # RuntimeError: the server itself closed the connection just now, as for a message that
            # is too large, and that was not heard of yet.
            raise _GoneError from gone

    async def _refuse(self, error: PilothouseError, code: int) -> None:
        await self._answer(error)
        await self._close(code, error.code)

    async def _close(self, code: int, reason: str) -> None:
        try:
            async with asyncio.timeout(_CLOSE_TIMEOUT_S):
                await self._socket.close(code, reason)
        except (TimeoutError, WebSocketDisconnect, RuntimeError):
            log.debug("%s went without a goodbye", self._address)
