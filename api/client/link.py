"""Subscribes to the stream of a service, and reconnects with growing pauses.

After a reconnect, events resume after the last one received.
"""

import asyncio
import json
import random
import socket
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import asynccontextmanager
from http import HTTPStatus
from itertools import chain, repeat
from typing import Any, NoReturn, Protocol

import httpx
import websockets
from websockets.asyncio.client import ClientConnection

from api.client.address import Address
from api.client.outcomes import (
    Json,
    NoAnswerError,
    ServiceProblemError,
    no_connection,
    token_hint,
)

SILENCE_S = 5.0
"""A dead peer never closes its connection: after this time without a frame, reconnect."""

_ANSWER_S = 5.0
_CLOSING_S = 1.0
_RETRY_S = (0.5, 1.0, 2.0, 4.0)
_MOST_BYTES = 64 * 2**20
"""Largest frame that is accepted; with 10,000 parts, a frame has about 4 MB."""
_ENDINGS = frozenset({1001, 1012})


class Listener(Protocol):
    """Receives the frames of a service."""

    def take(self, message: Json, /) -> None:
        """Process a frame of the stream."""
        ...

    def lose(self, why: str) -> None:
        """Handle a lost connection, or a failed attempt to connect.

        Args:
            why: The reason, in words.
        """
        ...


class Link:
    """Passes the frames of a stream to a listener."""

    def __init__(self, address: Address, listener: Listener, topics: Sequence[str] = ()) -> None:
        """Prepare to connect; nothing is sent yet.

        Args:
            address: URL of the service, and the token.
            listener: Receives the frames.
            topics: Topics to subscribe to; empty: all.
        """
        self._address = address
        self._topics = topics
        self._listener = listener
        self._epoch: str | None = None
        self._last_event_id = 0
        self._is_heard = False
        """Whether a `state` frame was received since the last attempt to connect began."""

    async def run(self) -> NoReturn:
        """Connect, and reconnect whenever the connection is lost.

        Raises:
            ServiceProblemError: The service denied access; a retry would not help.
        """
        pauses = _pauses()
        while True:
            self._is_heard = False
            try:
                await self.serve()
            except NoAnswerError as error:
                self._listener.lose(str(error))
            if self._is_heard:
                pauses = _pauses()
            await asyncio.sleep(next(pauses))

    async def serve(self) -> None:
        """Connect once, and pass frames to the listener until the connection is lost.

        Raises:
            NoAnswerError: The service did not answer, or the connection was lost.
            ServiceProblemError: The service denied access.
        """
        await self._knock()
        async with self._stream() as stream:
            await self._read(stream)

    @asynccontextmanager
    async def _stream(self) -> AsyncIterator[ClientConnection]:
        address = self._address
        try:
            stream = await websockets.connect(
                address.stream_url(self._topics, self._epoch, self._last_event_id),
                additional_headers=address.headers,
                max_size=_MOST_BYTES,
                open_timeout=_ANSWER_S,
                close_timeout=_CLOSING_S,
                sock=await _socket(address),
            )
        except websockets.InvalidStatus as error:
            status = error.response.status_code
            raise _refusal(_problem_in(error.response.body, status), self._address) from error
        except (OSError, websockets.WebSocketException) as error:
            raise NoAnswerError(f"no stream at {address.url}: {_why(error)}") from error
        try:
            yield stream
        finally:
            await stream.close()

    async def _read(self, stream: ClientConnection) -> NoReturn:
        while True:
            try:
                async with asyncio.timeout(SILENCE_S):
                    frame = json.loads(await stream.recv())
            except TimeoutError as error:
                raise NoAnswerError(f"no frame for {SILENCE_S:g} s") from error
            except websockets.ConnectionClosed as error:
                raise NoAnswerError(_closing_words(error)) from error
            if frame["type"] == "problem":
                raise _refusal(frame, self._address)
            self._listener.take(frame)
            self._remember(frame)

    def _remember(self, frame: Json) -> None:
        """Remember the last event received; after a reconnect, the stream resumes after it."""
        match frame["type"]:
            case "hello" if self._epoch is None:
                self._epoch, self._last_event_id = frame["epoch"], frame["newest"]
            case "hello" if frame["epoch"] != self._epoch:
                # Ids go on if the service kept its earlier runs.
                self._epoch = frame["epoch"]
                self._last_event_id = self._last_event_id if frame["boot"] > 1 else 0
            case "event":
                self._last_event_id = max(self._last_event_id, frame["id"])
            case "gap":
                self._last_event_id = max(self._last_event_id, frame["to"] or 0)
            case "state":
                self._is_heard = True

    async def _knock(self) -> None:
        """Check access over HTTP, which rejects at once; the stream first waits for a token."""
        url = self._address.url
        try:
            async with self._http() as http:
                response = await http.get("/system_state")
        except httpx.ConnectError as error:
            raise no_connection(url, error) from error
        except httpx.HTTPError as error:
            why = str(error) or f"timed out after {_ANSWER_S:g} s"
            raise NoAnswerError(f"no answer from {url}: {why}") from error
        if response.is_error:
            raise _refusal(_problem_in(response.content, response.status_code), self._address)
        if "task_status" not in (_object_in(response.content) or {}):
            raise NoAnswerError(f"what answers at {url} is not Pilothouse")

    def _http(self) -> httpx.AsyncClient:
        # A proxy set in the environment cannot reach this machine.
        return httpx.AsyncClient(
            base_url=self._address.url,
            headers=self._address.headers,
            timeout=_ANSWER_S,
            trust_env=self._address.loopback is None,
        )


async def _socket(address: Address) -> socket.socket | None:
    """Return a connection to this machine, past any proxy; None: the library connects."""
    if address.loopback is None:
        return None
    return await asyncio.to_thread(socket.create_connection, address.loopback, _ANSWER_S)


def _pauses() -> Iterator[float]:
    """Yield growing pauses in s, with jitter, so that clients do not all reconnect at once."""
    for pause_s in chain(_RETRY_S, repeat(_RETRY_S[-1])):
        yield pause_s * random.uniform(0.8, 1.2)


def _why(error: Exception) -> str:
    return str(error) or type(error).__name__


def _object_in(content: bytes | bytearray | None) -> dict[str, Any] | None:
    try:
        found = json.loads(content or b"")
    except ValueError:
        return None
    return found if isinstance(found, dict) else None


def _problem_in(content: bytes | bytearray | None, status: int) -> dict[str, Any]:
    found = _object_in(content) or {"detail": f"the server answered {status}: is it Pilothouse?"}
    return {**found, "status": status}


def _refusal(problem: Json, address: Address) -> ServiceProblemError | NoAnswerError:
    """Return the error for a problem: `NoAnswerError` if a retry may help."""
    if problem["status"] == HTTPStatus.UNAUTHORIZED:
        return ServiceProblemError({**problem, "hint": token_hint(given=address.token is not None)})
    if problem["status"] == HTTPStatus.FORBIDDEN:
        return ServiceProblemError(problem)
    return NoAnswerError(str(problem.get("detail") or problem.get("title") or problem["status"]))


def _closing_words(error: websockets.ConnectionClosed) -> str:
    frame = error.rcvd
    if frame is None:
        return "the connection was lost"
    if frame.code in _ENDINGS:
        return "the service stopped or is restarting"
    return f"the service closed the stream: {frame.reason or frame.code}"
