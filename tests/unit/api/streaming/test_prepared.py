import asyncio

import pytest
from websockets.client import ClientProtocol
from websockets.frames import Frame, Opcode
from websockets.uri import parse_uri

from api.streaming.prepared import EXTENSION, text_frame, transport_of


@pytest.mark.parametrize("length", [0, 1, 125, 126, 65_535, 65_536, 200_000])
def test_a_client_reads_the_text_that_was_prepared(length: int) -> None:
    text = "ä" * (length // 2) + "x" * (length % 2)
    client = ClientProtocol(parse_uri("ws://localhost/"), state=1, max_size=None)  # type: ignore[arg-type]

    client.receive_data(text_frame(text))

    (frame,) = client.events_received()
    assert isinstance(frame, Frame)
    assert (frame.opcode, frame.fin, bytes(frame.data).decode()) == (Opcode.TEXT, True, text)


def test_a_frame_of_a_server_is_not_masked_and_so_the_same_for_all() -> None:
    assert text_frame("state") == b"\x81\x05state"


def test_the_transport_is_that_of_the_scope() -> None:
    transport = asyncio.WriteTransport()

    assert transport_of({"extensions": {EXTENSION: {"transport": transport}}}) is transport


def test_a_server_without_the_extension_is_named() -> None:
    with pytest.raises(LookupError, match=r"no ASGI extension 'pilothouse\.frames'"):
        transport_of({"extensions": {"websocket.http.response": {}}})
