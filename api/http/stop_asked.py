"""Finds what asks for a stop in a message that is not valid otherwise.

A stop is taken whatever stands around it: unknown or wrong members, a member that occurs twice
with different values, or text that is no JSON. All that is found here can only engage a stop;
only a valid message releases one.
"""

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from domain.errors import InvalidValueError, PilothouseError
from domain.health.signals import ESTOP_SIGNAL, asks_for_stop
from service.ros.interface.reading_topics import STOP_FIELDS

_NAMES = (ESTOP_SIGNAL, f"/{ESTOP_SIGNAL}")

_MOST_DIGITS = 20
"""Enough for 64 bits."""

_Members: TypeAlias = "tuple[tuple[str, Any], ...]"
"""All members of a JSON object, also those with the same name."""


def stop_body(raw: bytes, member: str, kept: Mapping[str, int]) -> dict[str, object] | None:
    """Return what is valid in a body that asks for a stop; None: it does not.

    Args:
        raw: The body.
        member: Name of the member that asks.
        kept: Names of further members that are kept if they are texts; longer texts than this
            number of characters are cut.
    """
    text = raw.decode("utf-8-sig", "replace")
    found = _parsed(text)
    if found is None:
        return {member: True} if _writes(text, (member,)) else None
    if not any(map(asks_for_stop, _every(found, member))):
        return None
    body: dict[str, object] = {member: True}
    for name, length in kept.items():
        texts = [value for value in _every(found, name) if isinstance(value, str) and value]
        if texts:
            # A lone surrogate cannot be encoded in an answer.
            body[name] = texts[0][:length].encode(errors="replace").decode()
    return body


def is_stop_of_stream(message: Mapping[str, Any]) -> bool:
    """Tell whether a message of a stream client is a reading that asks for a stop."""
    text = _text_of(message)
    found = _parsed(text)
    if found is None:
        return _names_estop(text, "signal") and _writes(text, ("value",))
    return _is_estop(found, "signal") and any(map(asks_for_stop, _every(found, "value")))


def source_of(message: Mapping[str, Any], longest: int) -> str | None:
    """Return the source that a message of a stream client names; None: no valid one."""
    for value in _every(_parsed(_text_of(message)), "source"):
        if isinstance(value, str) and 0 < len(value) <= longest and value.isprintable():
            return value
    return None


def members_of(message: Mapping[str, Any]) -> dict[str, Any]:
    """Return the first of the members of each name of a message that is invalid JSON for us."""
    found = _parsed(_text_of(message))
    members: _Members = found if isinstance(found, tuple) else ()
    return {name: _encodable(value) for name, value in reversed(members)}


def _encodable(value: object) -> object:
    """Return a text without lone surrogates; any other value unchanged."""
    return value.encode(errors="replace").decode() if isinstance(value, str) else value


class StopTakenError(InvalidValueError):
    """A stop that was taken; the rest of its message was ignored."""

    code = "STOP_TAKEN"

    def __init__(self, ignored: PilothouseError) -> None:
        super().__init__(f"the stop was taken; ignored: {ignored.message}")


def is_stop_of_rosbridge(message: Mapping[str, Any]) -> bool:
    """Tell whether a message of a rosbridge client publishes what asks for a stop."""
    text = _text_of(message)
    found = _parsed(text)
    if found is None:
        return _names_estop(text, "topic") and _writes(text, STOP_FIELDS)
    return _is_estop(found, "topic") and any(
        asks_for_stop(value)
        for published in _every(found, "msg")
        for value in _every(published, *STOP_FIELDS)
    )


def may_ask_rosbridge(text: str) -> bool:
    """Tell, without parsing a text, whether it may publish what asks for a stop."""
    return ESTOP_SIGNAL in text and _writes(text, STOP_FIELDS)


def _text_of(message: Mapping[str, Any]) -> str:
    """Return the text of an ASGI message, also if it was sent as binary."""
    text = message.get("text")
    if isinstance(text, str):
        return text
    return bytes(message.get("bytes") or b"").decode(errors="replace")


def _parsed(text: str) -> object | None:
    """Return JSON with objects as tuples of all their members; None: it is no JSON."""
    try:
        found: object = json.loads(text, object_pairs_hook=tuple, parse_int=_whole)
    except (ValueError, RecursionError):
        return None
    return found


def _whole(text: str) -> int | float:
    """Return a whole number; one with too many digits for Python as a float."""
    return int(text) if len(text) <= _MOST_DIGITS else float(text)


def _every(found: object, *names: str) -> Iterable[Any]:
    """Yield the values of all members of an object with one of these names."""
    # An array is a list, so only objects are tuples.
    members: _Members = found if isinstance(found, tuple) else ()
    return (value for name, value in members if name in names)


def _is_estop(found: object, member: str) -> bool:
    return any(value in _NAMES for value in _every(found, member) if isinstance(value, str))


def _names_estop(text: str, member: str) -> bool:
    return re.search(rf"{member}[\"']?\s*:\s*[\"']/?{ESTOP_SIGNAL}[\"']", text) is not None


def _writes(text: str, members: tuple[str, ...]) -> bool:
    """Tell whether a text gives one of the members a value that asks for a stop."""
    pattern = (
        rf"\b(?:{'|'.join(members)})[\"']?\s*[:=]\s*[\"']?\s*(?:true|yes|on|1(?:\.0*)?)(?![\w.])"
    )
    return re.search(pattern, text, re.IGNORECASE) is not None
