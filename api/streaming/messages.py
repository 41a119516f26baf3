"""What clients may say over the stream: readings, one per message."""

from collections.abc import Mapping
from typing import Any

from api.bodies import parse_body
from api.schemas.stream import ReadingMessage
from domain.errors import InvalidValueError


def read_client_message(message: Mapping[str, Any]) -> ReadingMessage:
    """Return what a client said.

    Args:
        message: As ASGI has it, with `text` or `bytes`.

    Raises:
        PilothouseError: It is no reading.
    """
    text = message.get("text")
    if text is None:
        raise InvalidValueError("binary messages are not read; send JSON as text")
    return parse_body(ReadingMessage, text.encode())
