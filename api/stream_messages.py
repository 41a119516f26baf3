"""What clients may say over the stream: readings, one per message."""

from collections.abc import Mapping
from datetime import datetime
from typing import Any

from api.bodies import InvalidBodyError, parse_body
from api.schemas_stream import ReadingMessage
from domain.errors import InvalidValueError
from domain.messages import Reading
from service.clock import Clock


def read_client_message(message: Mapping[str, Any], clock: Clock) -> tuple[Reading, str]:
    """Return the reading that a message holds, and its source.

    Args:
        message: As ASGI has it, `text` or `bytes`.
        clock: What stamps are moved to.

    Raises:
        PilothouseError: It is no reading.
    """
    text = message.get("text")
    if text is None:
        raise InvalidValueError("binary messages are not read; send JSON as text")
    given = parse_body(ReadingMessage, text.encode("utf-8", "surrogatepass"))
    stamp = None
    if given.stamp is not None:
        try:
            stamp = clock.from_wall(datetime.fromisoformat(given.stamp))
        except ValueError as error:
            wrong = InvalidValueError(f"{given.stamp!r} is no time such as 2026-05-04T12:00:00Z")
            raise InvalidBodyError.at("stamp", wrong) from error
        except InvalidValueError as error:
            raise InvalidBodyError.at("stamp", error) from error
    return Reading(given.signal, given.value, stamp), given.source
