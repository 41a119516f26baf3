"""The extended protocol between a real client's bytes and an application, without a network."""

import asyncio
from collections.abc import AsyncIterator, Callable
from typing import Any

import pytest
import uvicorn
from starlette.types import Receive, Scope, Send
from uvicorn.server import ServerState
from websockets.client import ClientProtocol
from websockets.frames import Frame
from websockets.uri import parse_uri

from api.serving.websocket_protocol import WebSocketProtocol
from api.streaming.websocket_frames import EXTENSION, PING, Connection, text_frame
from tests.support.waiting import until


class Wire(asyncio.Transport):
    """What the server writes goes to the client at once."""

    def __init__(self, client: ClientProtocol) -> None:
        super().__init__()
        self.aborted = False
        self.high: int | None = None
        self._client = client
        self._closing = False

    def write(self, data: bytes | bytearray | memoryview) -> None:
        self._client.receive_data(bytes(data))

    def get_write_buffer_size(self) -> int:
        return 0

    def set_write_buffer_limits(self, high: int | None = None, low: int | None = None) -> None:
        self.high = high

    def is_closing(self) -> bool:
        return self._closing

    def close(self) -> None:
        self._closing = True

    def abort(self) -> None:
        self._closing = self.aborted = True

    def pause_reading(self) -> None:
        pass

    def resume_reading(self) -> None:
        pass


class Recorder:
    """Keeps what it learns of a connection."""

    def __init__(self) -> None:
        self.learned: list[str] = []

    def clogged(self) -> None:
        self.learned.append("clogged")

    def answered(self) -> None:
        self.learned.append("answered")

    def lost(self) -> None:
        self.learned.append("lost")


class Link:
    """A client that is connected to an application behind the protocol."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *, lets_in: bool = True) -> None:
        self.lets_in = lets_in
        self.scope: Scope = {}
        self.heard: list[Any] = []
        self.parsed = 0
        config = uvicorn.Config(
            self._app,
            ws=WebSocketProtocol,
            ws_ping_interval=None,
            ws_per_message_deflate=False,
            interface="asgi3",
            log_config=None,
        )
        config.load()
        self.client = ClientProtocol(parse_uri("ws://localhost/ws"))
        self.wire = Wire(self.client)
        self.server = WebSocketProtocol(config, ServerState(), {})
        self.server.connection_made(self.wire)
        handle = self.server.handle_events
        monkeypatch.setattr(self.server, "handle_events", lambda: self._note_parsed(handle))

    async def connect(self) -> None:
        self.client.send_request(self.client.connect())
        self.flush()
        await until(lambda: bool(self.heard))

    async def end(self) -> None:
        self.server.connection_lost(ConnectionResetError())
        await until(lambda: not self.server.tasks)

    def flush(self, piece: int | None = None) -> None:
        """Let the server receive what the client has to say, in pieces of so many bytes."""
        data = b"".join(self.client.data_to_send())
        for at in range(0, len(data), piece or max(1, len(data))):
            self.server.data_received(data[at : at + (piece or len(data))])

    @property
    def connection(self) -> Connection:
        found = self.scope["extensions"][EXTENSION]["connection"]
        assert isinstance(found, Connection)
        return found

    def ping(self) -> None:
        """Ping the client, which has the answer ready then."""
        self.connection.transport.write(PING)

    def _note_parsed(self, handle: Callable[[], None]) -> None:
        self.parsed += 1
        handle()

    async def _app(self, scope: Scope, receive: Receive, send: Send) -> None:
        self.scope = scope
        while True:
            message = await receive()
            self.heard.append(message)
            if message["type"] == "websocket.connect":
                await send({"type": "websocket.accept"})
                if self.lets_in:
                    self.connection.let_in()
            elif message["type"] == "websocket.disconnect":
                return


@pytest.fixture
async def link(monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[Link]:
    link = Link(monkeypatch)
    await link.connect()
    yield link
    await link.end()


async def test_an_application_can_write_prepared_frames_to_the_transport(link: Link) -> None:
    link.client.events_received()

    link.connection.transport.write(text_frame("state"))

    (frame,) = (event for event in link.client.events_received() if isinstance(event, Frame))
    assert bytes(frame.data) == b"state"


async def test_an_answered_ping_is_told_without_the_parser(link: Link) -> None:
    listener = Recorder()
    link.connection.listen(listener)
    before = link.parsed

    link.ping()
    link.flush()

    assert listener.learned == ["answered"]
    assert link.parsed == before


async def test_whoever_only_talks_is_not_taken_to_read(link: Link) -> None:
    listener = Recorder()
    link.connection.listen(listener)

    link.client.send_text(b"hello")
    link.flush()

    assert listener.learned == []


async def test_an_answer_behind_a_message_is_told_too(link: Link) -> None:
    listener = Recorder()
    link.connection.listen(listener)

    link.client.send_text(b"hello")
    link.ping()
    link.flush()

    assert listener.learned == ["answered"]


async def test_what_the_network_does_not_take_is_told_at_once(link: Link) -> None:
    listener = Recorder()
    link.connection.listen(listener)

    link.server.pause_writing()
    link.server.resume_writing()

    assert link.wire.high == 0
    assert listener.learned == ["clogged"]


async def test_whoever_listened_last_learns_nothing_more(link: Link) -> None:
    listener = Recorder()
    link.connection.listen(listener)
    link.connection.listen(None)

    link.server.pause_writing()
    link.ping()
    link.flush()

    assert listener.learned == []


async def test_a_lost_connection_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    link = Link(monkeypatch)
    await link.connect()
    listener = Recorder()
    link.connection.listen(listener)

    await link.end()

    assert listener.learned == ["lost"]
    assert link.heard[-1]["type"] == "websocket.disconnect"


@pytest.mark.parametrize("length", [0, 4, 125, 126, 70_000])
async def test_what_a_client_says_between_pings_is_heard(link: Link, length: int) -> None:
    link.ping()
    link.flush()

    link.client.send_text(b"x" * length)
    link.flush()
    await until(lambda: link.heard[-1]["type"] == "websocket.receive")
    before = link.parsed
    link.ping()
    link.flush()

    assert link.heard[-1]["text"] == "x" * length
    assert link.parsed == before


async def test_bytes_that_look_like_an_answer_inside_a_message_are_part_of_it(link: Link) -> None:
    # It holds, on the wire, what a whole masked pong looks like, and that comes as a piece of its
    # own, as from a slow network.
    link.client.send_binary(bytes(30))
    data = b"".join(link.client.data_to_send())
    pong = b"\x8a\x84" + bytes(8)

    for piece in (data[:16], pong, data[26:]):
        link.server.data_received(piece)
    await until(lambda: link.heard[-1]["type"] == "websocket.receive")

    assert len(link.heard[-1]["bytes"]) == 30


async def test_an_answer_in_pieces_is_told_and_does_no_harm(link: Link) -> None:
    listener = Recorder()
    link.connection.listen(listener)
    link.ping()
    link.flush(piece=3)
    assert listener.learned == ["answered"]

    link.client.send_text(b"hello")
    link.flush()
    await until(lambda: link.heard[-1]["type"] == "websocket.receive")

    assert link.heard[-1]["text"] == "hello"


async def test_when_the_application_ends_so_does_the_connection(
    link: Link, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("api.serving.websocket_protocol._LAST_WORDS_S", 0.0)
    link.client.send_close(1000)
    link.flush()

    await until(lambda: link.wire.aborted)


@pytest.mark.parametrize(
    "frames",
    [
        b"\x89\x80\0\0\0\0",  # ping
        b"\x8a\x80\0\0\0\0",  # pong
        b"\x81\x80\0\0\0\0",  # empty text
        b"\x01\x80\0\0\0\0",  # empty first fragment
        b"\x81\xfe\x20\x00\0\0\0\0" + bytes(0x2000),  # a long message
    ],
)
async def test_a_client_without_a_token_may_send_only_one_short_message(
    frames: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    link = Link(monkeypatch, lets_in=False)
    await link.connect()

    link.server.data_received(frames)
    await until(lambda: link.heard[-1]["type"] == "websocket.disconnect")

    assert link.heard[-1]["code"] == 1008
    assert link.wire.is_closing()
    await link.end()


async def test_a_message_of_endless_fragments_is_ended(link: Link) -> None:
    link.server.data_received(b"\x01\x80\0\0\0\0")

    link.server.data_received(b"\x00\x80\0\0\0\0" * 1_000)
    await until(lambda: link.heard[-1]["type"] == "websocket.disconnect")

    assert link.wire.is_closing()


async def test_invalid_utf_8_is_refused_without_a_traceback(
    link: Link, caplog: pytest.LogCaptureFixture
) -> None:
    link.server.data_received(b"\x81\x81\0\0\0\0\xff")
    await until(lambda: link.heard[-1]["type"] == "websocket.disconnect")

    assert link.heard[-1]["code"] == 1007
    assert "Traceback" not in caplog.text
