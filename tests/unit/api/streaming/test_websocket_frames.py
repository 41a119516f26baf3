import asyncio

import pytest
from websockets.client import ClientProtocol
from websockets.frames import Frame, Opcode
from websockets.protocol import State
from websockets.uri import parse_uri

from api.streaming.websocket_frames import EXTENSION, PING, Connection, connection_of, text_frame


@pytest.mark.parametrize("length", [0, 1, 125, 126, 65_535, 65_536, 200_000])
def test_a_client_reads_the_text_that_was_prepared(length: int) -> None:
    text = "ä" * (length // 2) + "x" * (length % 2)
    client = ClientProtocol(parse_uri("ws://localhost/"), state=State.OPEN, max_size=None)

    client.receive_data(text_frame(text))

    (frame,) = client.events_received()
    assert isinstance(frame, Frame)
    assert (frame.opcode, frame.fin, bytes(frame.data).decode()) == (Opcode.TEXT, True, text)


def test_a_frame_of_a_server_is_not_masked_and_so_the_same_for_all() -> None:
    assert text_frame("state") == text_frame(b"state") == b"\x81\x05state"


def test_a_client_answers_the_ping_with_the_same_bytes() -> None:
    client = ClientProtocol(parse_uri("ws://localhost/"), state=State.OPEN)

    client.receive_data(PING)

    answer = b"".join(client.data_to_send())
    assert (answer[:2], len(answer)) == (b"\x8a\x84", 10)


def test_the_connection_is_that_of_the_scope() -> None:
    connection = Connection(asyncio.WriteTransport(), lambda _: None, lambda: None)

    assert connection_of({"extensions": {EXTENSION: {"connection": connection}}}) is connection


def test_a_server_without_the_extension_is_named() -> None:
    with pytest.raises(LookupError, match=r"no ASGI extension 'pilothouse\.frames'"):
        connection_of({"extensions": {"websocket.http.response": {}}})
