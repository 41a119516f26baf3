"""`WS /rosbridge`: the topics and services of the ROS interface, for clients without ROS."""

import asyncio
import logging
from collections.abc import Mapping
from contextlib import suppress
from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from api.http.access import READS_ONLY, UnauthorizedError
from api.http.route_policy import AuditClass, Permission, policy
from api.rosbridge.clients import RosbridgeClients, RosbridgeClientsDep
from api.rosbridge.operations import Authenticate, id_of, read_message, read_operation
from api.rosbridge.replies import status_text
from api.rosbridge.served_client import ServedClient
from api.streaming.websocket_frames import Connection, connection_of
from domain.errors import PilothouseError

router = APIRouter()
log = logging.getLogger(__name__)

AUTH_TIMEOUT_S = 5.0
"""Timeout for the token of a client, s."""
_LAST_WORDS_S = 1.0

_TRY_AGAIN_LATER = 1013
_UNAUTHORIZED = 4401


# Not the handshake: each call of a service has an event of its own.
@router.websocket("/rosbridge")
@policy(Permission.OPERATE, AuditClass.NEVER)
async def rosbridge(socket: WebSocket, clients: RosbridgeClientsDep) -> None:
    """Serve one client until it disconnects, stops reading, or the service ends."""
    await socket.accept()
    address = socket.client.host if socket.client else "unknown"
    connection = connection_of(socket.scope)
    if not await _is_let_in(socket, connection, clients, address):
        return
    connection.let_in()
    if clients.is_full:
        await _close(socket, _TRY_AGAIN_LATER, "too many clients")
    elif not connection.transport.is_closing():
        async with clients.serve(connection.transport) as bridge:
            reads_only = bool(socket.scope.get(READS_ONLY))
            client = ServedClient(bridge, connection, address, reads_only=reads_only)
            await client.serve(socket.receive)


async def _is_let_in(
    socket: WebSocket, connection: Connection, clients: RosbridgeClients, address: str
) -> bool:
    """Wait for the token, if one is needed and the handshake did not carry it.

    A client that does not send it gets an error status, and its connection is closed.
    """
    lobby = clients.lobby
    if lobby.access.accepts_header(socket.headers):
        return True
    said: Mapping[str, Any] = {}
    try:
        with lobby.host_stranger(connection.transport):
            async with asyncio.timeout(AUTH_TIMEOUT_S):
                message = await socket.receive()
        if message["type"] == "websocket.disconnect":
            return False
        with suppress(PilothouseError):
            said = read_message(message)
        _check_token(clients, said)
    except (TimeoutError, UnauthorizedError) as error:
        reason = str(error) or f"no token was sent within {AUTH_TIMEOUT_S:g} s"
        lobby.refusals.note(HTTPStatus.UNAUTHORIZED, address)
        await _close(
            socket, _UNAUTHORIZED, "UNAUTHORIZED", status_text("error", reason, id_of(said))
        )
        return False
    return True


def _check_token(clients: RosbridgeClients, said: Mapping[str, Any]) -> None:
    """Check the first message.

    Raises:
        UnauthorizedError: It is not the right token.
    """
    try:
        operation = read_operation(said)
    except PilothouseError:
        operation = None
    if not isinstance(operation, Authenticate) or operation.token is None:
        raise UnauthorizedError('the first message must be {"op": "auth", "token": "..."}')
    if not clients.lobby.access.accepts(operation.token):
        raise UnauthorizedError("wrong token")


async def _close(socket: WebSocket, code: int, reason: str, last_words: str | None = None) -> None:
    try:
        async with asyncio.timeout(_LAST_WORDS_S):
            if last_words is not None:
                await socket.send_text(last_words)
            await socket.close(code, reason)
    except (TimeoutError, WebSocketDisconnect, RuntimeError):
        # RuntimeError: the server has just closed the connection itself, for example because a
        # message was too large.
        log.debug("a client disconnected before it was sent: %s", reason)
