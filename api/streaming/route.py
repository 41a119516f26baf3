"""`WS /ws`: frames and events to each client at its own pace, and readings from it.

`api.streaming.fan_out` writes frames to all clients at once. Here each client has one coroutine
that authenticates it and reads its messages.
"""

import asyncio
import logging
from collections.abc import Mapping
from contextlib import suppress
from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from api.http.access import READS_ONLY, ReadsOnlyError, UnauthorizedError
from api.http.body_parsing import InvalidBodyError
from api.http.route_policy import Permission, policy
from api.http.schemas.health import MAX_SOURCE
from api.http.schemas.stream import AuthMessage, ResyncMessage
from api.http.stop_asked import StopTakenError, is_stop_of_stream, source_of
from api.streaming.client_input import read_client_message, read_stream_query
from api.streaming.stream_client import StreamClient
from api.streaming.stream_server import StreamServer, StreamServerDep
from api.streaming.websocket_frames import connection_of, text_frame
from domain.actor import Actor
from domain.errors import InvalidValueError, PilothouseError
from domain.health.signals import ESTOP_SIGNAL
from domain.inputs import Reading

router = APIRouter()
log = logging.getLogger(__name__)

AUTH_TIMEOUT_S = 5.0
"""Timeout for the token of a client, s."""
ANSWER_TIMEOUT_S = 4.5
"""Timeout for a client to read the answer to its message, s."""
_CLOSE_TIMEOUT_S = 1.0

_POLICY_VIOLATION = 1008
_TRY_AGAIN_LATER = 1013
_UNAUTHORIZED = 4401


@router.websocket("/ws")
@policy(Permission.OBSERVE)
async def stream(socket: WebSocket, server: StreamServerDep) -> None:
    """Serve one client until it disconnects, stops reading, or the service ends.

    An invalid query is reported after the handshake, with a `problem` frame and close code 1008,
    since a browser does not tell a page why its handshake was rejected.
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
    """The client has disconnected."""


class _Client:
    """One client of the stream."""

    def __init__(self, socket: WebSocket, server: StreamServer) -> None:
        self._socket = socket
        self._connection = connection_of(socket.scope)
        self._server = server
        self._address = socket.client.host if socket.client else "unknown"
        self._reads_only = bool(socket.scope.get(READS_ONLY))

    async def is_let_in(self) -> bool:
        """Ask for the token, where one is needed and the handshake did not hold it.

        Whoever does not give it is told so, and the connection is closed.

        Raises:
            _GoneError: The client went.
        """
        server = self._server
        if server.access.accepts_header(self._socket.headers):
            self._connection.let_in()
            return True
        try:
            with server.host_stranger(self._connection.transport):
                await self._hear_token()
        except UnauthorizedError as error:
            server.refusals.note(HTTPStatus.UNAUTHORIZED, self._address)
            await self._refuse(error, _UNAUTHORIZED)
            return False
        self._connection.let_in()
        return True

    async def send_away(self) -> None:
        """Close, since there are too many clients."""
        await self._close(_TRY_AGAIN_LATER, "too many clients")

    async def serve(self) -> None:
        """Write to the client and read its messages until it disconnects.

        Raises:
            _GoneError: It disconnected.
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
        await encoder.prepare(query.topics)
        with self._server.fan_out.serve(self._connection, query, self._address) as client:
            await self._listen(client)

    async def _hear_token(self) -> None:
        """Check the first message.

        Raises:
            UnauthorizedError: It is not the right token, or it is late.
        """
        try:
            async with asyncio.timeout(AUTH_TIMEOUT_S):
                message = await self._receive()
        except TimeoutError as error:
            raise UnauthorizedError(f"no token was sent within {AUTH_TIMEOUT_S:g} s") from error
        try:
            said = read_client_message(message)
        except PilothouseError:
            said = None
        if not isinstance(said, AuthMessage):
            raise UnauthorizedError("the first message must be the token")
        if not self._server.access.accepts(said.token):
            raise UnauthorizedError("wrong token")

    async def _listen(self, client: StreamClient) -> None:
        """Process one message after the other; further ones wait in the connection."""
        while True:
            message = await self._receive()
            try:
                self._take(message, client)
            except PilothouseError as error:
                await self._answer(error)
            # Messages that came together are available at once: other tasks must run in between.
            await asyncio.sleep(0)

    async def _receive(self) -> Mapping[str, Any]:
        message = await self._socket.receive()
        if message["type"] == "websocket.disconnect":
            raise _GoneError
        return message

    def _take(self, message: Mapping[str, Any], client: StreamClient) -> None:
        """Process a message; a stop is taken whatever else is in it.

        Raises:
            PilothouseError: It is rejected, or a part of it was ignored.
        """
        try:
            self._obey(message, client)
        except PilothouseError as error:
            supervisor, actor = self._server.supervisor, self._actor
            if self._reads_only or not is_stop_of_stream(message):
                supervisor.refused_readings.note(actor, error.message)
                raise
            stop = Reading(ESTOP_SIGNAL, True)
            supervisor.readings.submit([stop], source_of(message, MAX_SOURCE), actor)
            supervisor.refused_readings.note_ignored(actor, error.message)
            raise StopTakenError(error) from error

    @property
    def _actor(self) -> Actor:
        return Actor(way="websocket", address=self._address)

    def _obey(self, message: Mapping[str, Any], client: StreamClient) -> None:
        supervisor = self._server.supervisor
        given = read_client_message(message)
        if isinstance(given, AuthMessage):
            # A page with a stored token sends it even if it is not needed.
            return
        if isinstance(given, ResyncMessage):
            self._server.fan_out.resync(client)
            return
        if self._reads_only:
            raise ReadsOnlyError
        reading = given.reading(given.signal, supervisor.clock)
        try:
            supervisor.readings.submit([reading], given.source, self._actor)
        except InvalidValueError as error:
            raise InvalidBodyError.at("value", error) from error

    async def _answer(self, error: PilothouseError) -> None:
        """Send a problem, once the client has read most of what was written before."""
        try:
            async with asyncio.timeout(ANSWER_TIMEOUT_S):
                await self._socket.send_text(self._server.encoder.problem(error))
        except TimeoutError as late:
            self._server.fan_out.drop(self._connection.transport, self._address)
            raise _GoneError from late
        except (WebSocketDisconnect, RuntimeError) as gone:
            # RuntimeError: the server has just closed the connection itself, for example because a
            # message was too large.
            raise _GoneError from gone

    async def _refuse(self, error: PilothouseError, code: int) -> None:
        await self._answer(error)
        await self._close(code, error.code)

    async def _close(self, code: int, reason: str) -> None:
        try:
            async with asyncio.timeout(_CLOSE_TIMEOUT_S):
                await self._socket.close(code, reason)
        except (TimeoutError, WebSocketDisconnect, RuntimeError):
            log.debug("client %s disconnected without a close frame", self._address)
