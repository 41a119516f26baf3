"""What clients may say over the stream: who they are, and readings, one per message."""

from collections.abc import Mapping
from typing import Any

from api.http.body_parsing import check_body, parse_json
from api.http.schemas.stream import AuthMessage, ReadingMessage
from domain.errors import InvalidValueError


def read_client_message(message: Mapping[str, Any]) -> ReadingMessage | AuthMessage:
    """Return what a client said.

    Args:
        message: As ASGI has it, with `text` or `bytes`.

    Raises:
        PilothouseError: It is neither a reading nor a token.
    """
    text = message.get("text")
    if text is None:
        raise InvalidValueError("binary messages are not read; send JSON as text")
    said = parse_json(text.encode())
    if isinstance(said, dict) and said.get("type") == "auth":
        return check_body(AuthMessage, said)
    return check_body(ReadingMessage, said)
