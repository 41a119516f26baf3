"""Uvicorn's HTTP/1.1 protocol, with limits that the parser in C does not have."""

from http import HTTPStatus
from typing import Any

import httptools
from uvicorn.config import Config
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol
from uvicorn.server import ServerState

from api.http.problems import MEDIA_TYPE, make_problem
from api.http.schemas.problem import Problem
from api.serving.closings import Closings
from api.serving.intake import Dispensable
from api.serving.pieces import (
    CHANGE_COST,
    HANDSHAKE_COST,
    HEAD_COST,
    INCOMPLETE,
    READ_COST,
    Piece,
    cost_of_bytes,
    cost_of_checking,
)
from api.serving.turns import Urgency
from domain.health.signals import ESTOP_SIGNAL

MAX_HEAD_BYTES = 65_536
MAX_HEADERS = 100
HEAD_TIMEOUT_S = 10.0
"""For a complete head, from the connection or the previous answer on, s."""
BODY_TIMEOUT_S = 10.0
"""For a body, beside the time that it takes at `MIN_BODY_BYTES_PER_S`, s."""
MIN_BODY_BYTES_PER_S = 1_024
UNREAD_TIMEOUT_S = 10.0
"""For a client that reads nothing of its answer, s."""
_BODY_PIECE = 16_384
_CHUNKED_PIECE = 1_024
_CHUNKED_COST = 300
"""Of such a piece, which may hold a hundred chunks, in nominal microseconds."""
_CHUNK_OVERHEAD = 8
"""Bytes that a byte of a body may take on the wire, if each is a chunk of its own."""
_STOPS = (b"PUT /emergency_stop", f"POST /signals/{ESTOP_SIGNAL}".encode())
_PAUSES = (b"PUT /holds/", b"DELETE /tasks/current", b"POST /signals")
"""Also what brings readings, of which one may be a stop and most are none."""
_QUESTIONS = (b"GET ", b"HEAD ")
_END_OF_HEAD = b"\r\n\r\n"
_UPGRADE = b"\r\nupgrade:"
# Their path is not known: they could not be parsed, or were not.
_MALFORMED = make_problem(
    HTTPStatus.BAD_REQUEST, "MALFORMED_REQUEST", "this is not a valid HTTP/1.1 request", "/"
)
_HEAD_TOO_LARGE = make_problem(
    HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE,
    "HEAD_TOO_LARGE",
    f"a request has at most {MAX_HEADERS} headers and {MAX_HEAD_BYTES} bytes before its body",
    "/",
)


class HttpProtocol(HttpToolsProtocol):
    """One connection.

    Heads are handed to the parser whole, one at a time; trailers are ignored.
    """

    def __init__(
        self,
        config: Config,
        server_state: ServerState,
        app_state: dict[str, Any],
        closings: Closings,
    ) -> None:
        """Prepare; all but `closings`, which counts rejected connections, is uvicorn's."""
        super().__init__(config, server_state, app_state)
        self._closings = closings
        self._searched = 0
        self.in_message = False
        """Whether a request has begun whose body is incomplete."""
        self._in_head = False
        self._body_left: int | None = 0
        """Bytes of the body still to come; None: it is chunked."""
        self._taken = self._body_bytes = 0
        self._since = self.loop.time()
        """When the service began to wait for the head or the body."""
        self._unsent = 0
        self._unsent_since = self._since

    # --- pieces ----------------------------------------------------------------------------------

    def next_piece(self, waiting: bytearray) -> Piece:
        """Return the next head, or a part of a body."""
        if not self.in_message:
            return self._next_head(waiting)
        if self._body_left is None:
            return _next_chunks(waiting, self._body_bytes)
        length = min(len(waiting), max(self._body_left, 1), _BODY_PIECE)
        is_last = length == self._body_left
        cost = cost_of_checking(self._body_bytes + length) if is_last else cost_of_bytes(length)
        return Piece(length, cost)

    def _next_head(self, waiting: bytearray) -> Piece:
        if not (65 <= waiting[0] <= 90 or waiting[0] in b"\r\n"):
            self._reject(_MALFORMED)
            return INCOMPLETE
        end = waiting.find(_END_OF_HEAD, self._searched)
        if end > MAX_HEAD_BYTES or (end < 0 and len(waiting) > MAX_HEAD_BYTES):
            self._reject(_HEAD_TOO_LARGE)
            return INCOMPLETE
        if end < 0:
            self._searched = max(0, len(waiting) - len(_END_OF_HEAD) + 1)
            return INCOMPLETE
        self._searched = 0
        if waiting.count(b"\r\n", 0, end) > MAX_HEADERS:
            self._reject(_HEAD_TOO_LARGE)
            return INCOMPLETE
        return Piece(end + len(_END_OF_HEAD), _cost_of_head(waiting[:end]) + cost_of_checking(end))

    def data_received(self, data: bytes) -> None:
        """Parse a piece; what is left of a lost connection is dropped."""
        if self.parser is None:
            return
        self._unset_keepalive_if_required()
        self._taken += len(data)
        try:
            self.parser.feed_data(data)
        except httptools.HttpParserUpgrade:
            if self._should_upgrade():
                self.handle_websocket_upgrade()
                # It refers to this protocol, which nothing else needs any more.
                self.parser = None  # type: ignore[assignment]
        except httptools.HttpParserError:
            self._reject(_MALFORMED)
        if self.in_message and self._body_left is None:
            overhead = self._taken - _CHUNK_OVERHEAD * self._body_bytes
            if overhead > MAX_HEAD_BYTES:
                self._reject(_MALFORMED)

    def on_message_begin(self) -> None:
        """Begin a request."""
        super().on_message_begin()
        self.in_message = self._in_head = True

    def on_header(self, name: bytes, value: bytes) -> None:
        """Take a header; trailers are of no use, and without a limit."""
        if self._in_head:
            super().on_header(name, value)

    def on_headers_complete(self) -> None:
        """Begin to wait for the body."""
        self._in_head = False
        headers = dict(self.headers)
        chunked = b"transfer-encoding" in headers
        self._body_left = None if chunked else int(headers.get(b"content-length", b"0"))
        self._taken = self._body_bytes = 0
        self._since = self.loop.time()
        super().on_headers_complete()

    def on_body(self, body: bytes) -> None:
        """Take a part of the body."""
        self._body_bytes += len(body)
        if self._body_left is not None:
            self._body_left -= len(body)
        super().on_body(body)

    def on_message_complete(self) -> None:
        """Begin to wait for the next head."""
        self.in_message = False
        super().on_message_complete()

    def on_response_complete(self) -> None:
        """Begin to wait for the next head."""
        self._since = self.loop.time()
        super().on_response_complete()

    # --- limits ----------------------------------------------------------------------------------

    @property
    def dispensable(self) -> Dispensable:
        """Return whether it may be closed for a new one."""
        if self.cycle is None or self.cycle.response_complete:
            return Dispensable.AT_ONCE
        return Dispensable.IF_NEEDED if self.in_message else Dispensable.NOT

    def overdue(self, now: float) -> str | None:
        """Return for what the client took too long; None: for nothing."""
        unsent = self.transport.get_write_buffer_size()
        if not unsent or unsent < self._unsent:
            self._unsent_since = now
        self._unsent = unsent
        if unsent:
            return "unread" if now - self._unsent_since > UNREAD_TIMEOUT_S else None
        waited = now - self._since
        if self.in_message:
            allowed = BODY_TIMEOUT_S + self._body_bytes / MIN_BODY_BYTES_PER_S
            # What the service itself makes wait is not the client's fault.
            return "body" if waited > allowed and not self.flow.read_paused else None
        waits = self.dispensable is Dispensable.AT_ONCE
        return "head" if waits and waited > HEAD_TIMEOUT_S else None

    def _reject(self, problem: Problem) -> None:
        """Answer what is no acceptable request, and close."""
        if self.transport.is_closing():
            return
        address = self.client[0] if self.client else "unknown"
        self._closings.note("malformed", address)
        body = problem.as_json().encode()
        phrase = HTTPStatus(problem.status).phrase
        head = (
            f"HTTP/1.1 {problem.status} {phrase}\r\ncontent-type: {MEDIA_TYPE}\r\n"
            f"content-length: {len(body)}\r\nconnection: close\r\n\r\n"
        )
        self.transport.write(head.encode() + body)
        self.transport.close()

    def connection_lost(self, exc: Exception | None) -> None:
        """Handle the end, and let go of the connection: the timer would keep it for a while."""
        super().connection_lost(exc)
        self._unset_keepalive_if_required()
        # Requests that were never begun refer to this protocol, as it refers to them.
        self.pipeline.clear()
        self.cycle = None  # type: ignore[assignment]


def _next_chunks(waiting: bytearray, before: int) -> Piece:
    """Return a part of a chunked body that holds nothing of a further request.

    Whatever its chunks and trailers are, it ends with an empty line. Where one is in a chunk, the
    piece is only shorter; where one may just begin, that waits for the rest of it.

    Args:
        waiting: What follows in the connection.
        before: Bytes of the body before it.
    """
    window = bytes(waiting[:_CHUNKED_PIECE])
    end = window.find(_END_OF_HEAD)
    if end < 0:
        begun = next((n for n in (3, 2, 1) if window.endswith(_END_OF_HEAD[:n])), 0)
        length = len(window) - begun
        return Piece(length, READ_COST + length * _CHUNKED_COST // _CHUNKED_PIECE)
    return Piece(end + len(_END_OF_HEAD), _CHUNKED_COST + cost_of_checking(before + end))


def _cost_of_head(head: bytearray) -> int:
    if _UPGRADE in head.lower():
        return HANDSHAKE_COST
    return HEAD_COST if head.startswith(_QUESTIONS) else CHANGE_COST


def urgency_of(head: bytes | bytearray) -> Urgency:
    """Return how urgent a request is that begins with this head."""
    if head.startswith(_STOPS):
        return Urgency.STOP
    return Urgency.PAUSE if head.startswith(_PAUSES) else Urgency.REST
