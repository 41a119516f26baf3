"""The query of a stream client, and the messages that it may send."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeAlias

from starlette.datastructures import ImmutableMultiDict

from api.http.body_parsing import check_body, parse_small
from api.http.schemas.stream import AuthMessage, ReadingMessage, ResyncMessage
from domain.errors import InvalidValueError, shortened

TOPICS = (
    "system_state",
    "parts",
    "signals",
    "errors",
    "reactions",
    "devices",
    "task",
    "vehicle",
    "holds",
    "emergency_stop",
    "events",
)
"""In the order in which they are listed."""

STATE_TOPICS = frozenset(TOPICS) - {"events"}

ClientMessage: TypeAlias = ReadingMessage | ResyncMessage | AuthMessage

_MESSAGES: Mapping[str, type[ClientMessage]] = MappingProxyType(
    {"reading": ReadingMessage, "resync": ResyncMessage, "auth": AuthMessage}
)


@dataclass(frozen=True, slots=True)
class StreamQuery:
    """The topics, and the event to start after."""

    topics: frozenset[str]
    after: int | None
    """Id of the last known event; None: only new events."""
    epoch: str | None

    @property
    def wants_state(self) -> bool:
        """Tell whether `state` frames are requested."""
        return bool(self.topics & STATE_TOPICS)

    @property
    def wants_events(self) -> bool:
        """Tell whether `event` frames are requested."""
        return "events" in self.topics


def read_stream_query(query: ImmutableMultiDict[str, str]) -> StreamQuery:
    """Read `topics`, `after` and `epoch`; `topics` may be repeated.

    Raises:
        InvalidValueError: There is an unknown topic, no topic, or an `after` that is not an id.
    """
    return StreamQuery(
        _topics(query.getlist("topics")), _after(query.get("after")), query.get("epoch")
    )


def _topics(texts: list[str]) -> frozenset[str]:
    if not texts:
        return frozenset(TOPICS)
    named = [name.strip() for text in texts for name in text.split(",") if name.strip()]
    unknown = [name for name in named if name not in TOPICS]
    if unknown:
        message = f"there is no topic {shortened(unknown[0])!r}; topics: {', '.join(TOPICS)}"
        raise InvalidValueError(message, "/topics")
    if not named:
        raise InvalidValueError(f"no topic is named; topics: {', '.join(TOPICS)}", "/topics")
    return frozenset(named)


def _after(text: str | None) -> int | None:
    if text is None:
        return None
    # isdecimal alone accepts digits of other scripts, and int() alone accepts "1_0" and " 1".
    if not (text.isascii() and text.isdecimal() and len(text) <= 18):
        raise InvalidValueError(f"invalid event id {text[:40]!r}: ids are 0, 1, 2, ...", "/after")
    return int(text)


def read_client_message(message: Mapping[str, Any]) -> ClientMessage:
    """Parse a message of a client.

    Args:
        message: An ASGI message with `text` or `bytes`.

    Raises:
        PilothouseError: It is not a message that a client may send.
    """
    text = message.get("text")
    if text is None:
        raise InvalidValueError("binary messages are not supported; send JSON as text")
    said = parse_small(text.encode())
    kind = said.get("type") if isinstance(said, dict) else None
    # A list is unhashable, so that a lookup would raise.
    message_class = _MESSAGES.get(kind) if isinstance(kind, str) else None
    if message_class is None:
        message_types = ", ".join(map(repr, _MESSAGES))
        raise InvalidValueError(f"`type` must be one of {message_types}", "/type")
    return check_body(message_class, said)
