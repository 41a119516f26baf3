import pytest

from api.http.schemas.stream import AuthMessage, ReadingMessage
from api.streaming.messages import read_client_message
from domain.errors import InvalidValueError, PilothouseError


def test_a_reading_is_read() -> None:
    text = '{"type":"reading","signal":"estop","value":true,"source":"pendant"}'

    given = read_client_message({"type": "websocket.receive", "text": text})

    assert isinstance(given, ReadingMessage)
    assert (given.signal, given.value, given.source) == ("estop", True, "pendant")


def test_who_measured_may_be_left_out() -> None:
    text = '{"type":"reading","signal":"battery_level","value":1}'

    given = read_client_message({"text": text})

    assert isinstance(given, ReadingMessage)
    assert given.source is None


def test_a_token_is_read() -> None:
    given = read_client_message({"text": '{"type":"auth","token":"secret"}'})

    assert given == AuthMessage(type="auth", token="secret")


def test_a_binary_message_is_not_read() -> None:
    with pytest.raises(InvalidValueError, match="binary"):
        read_client_message({"type": "websocket.receive", "bytes": b"{}", "text": None})


@pytest.mark.parametrize(
    "text",
    [
        '{"type":"readings","signal":"estop","value":true}',
        '{"type":"reading","signal":"","value":true}',
        '{"type":"auth"}',
        '{"type":"reading","signal":"estop","value":[true]}',
        '{"type":"reading","signal":"estop","value":true,"stamp":1}',
    ],
    ids=["unknown type", "no name", "no token", "a list", "a stamp that is no text"],
)
def test_what_is_no_reading_is_refused(text: str) -> None:
    with pytest.raises(PilothouseError):
        read_client_message({"text": text})
