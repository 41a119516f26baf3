"""Finds what asks for a stop in a message that is not valid otherwise.

A stop is taken whatever stands around it: unknown or wrong members, a member that occurs twice
with different values, objects and lists around it, or text that is no JSON or only its beginning.
All that is found here can only engage a stop; only a valid message releases one.
"""

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from domain.errors import InvalidValueError, PilothouseError
from domain.health.signals import ESTOP_SIGNAL, asks_for_stop, signal_name
from service.ros.interface.reading_topics import STOP_FIELDS

_MOST_DIGITS = 20
"""Enough for 64 bits."""
_MOST_MARKS = 10_000
"""Brackets and colons in what is parsed here, a few ms of work; other text is only searched."""

_Members: TypeAlias = "tuple[tuple[str, Any], ...]"
"""All members of a JSON object, also those with the same name."""


def stop_body(raw: bytes, member: str, kept: Mapping[str, int]) -> dict[str, object] | None:
    """Return what is valid in a body that asks for a stop; None: it does not.

    Args:
        raw: The body, or as much of it as was read.
        member: Name of the member that asks.
        kept: Names of further members that are kept if they are texts; longer texts than this
            number of characters are cut.
    """
    text = _text_of(raw)
    found = _parsed(text)
    if found is None:
        asks = _writes(text, (member,))
    else:
        asks = _asks_in(found, member) or _asks_named(found, "signal", ("value",))
    return {member: True, **texts_in(found, kept)} if asks else None


def kept_texts(raw: bytes, kept: Mapping[str, int]) -> dict[str, str]:
    """Return the members of a body that are kept if they are texts, as `stop_body` does."""
    return texts_in(_parsed(_text_of(raw)), kept)


def texts_in(found: object, kept: Mapping[str, int]) -> dict[str, str]:
    """Return texts, cut to a number of characters each, from members of an object."""
    texts = {}
    for name, length in kept.items():
        said = [value for value in _every(found, name) if isinstance(value, str) and value]
        if said:
            # A lone surrogate cannot be encoded in an answer.
            texts[name] = said[0][:length].encode(errors="replace").decode()
    return texts


def is_stop_of_stream(message: Mapping[str, Any]) -> bool:
    """Tell whether a message of a stream client is a reading that asks for a stop."""
    text = _text_in(message)
    found = _parsed(text)
    if found is None:
        return _names_estop(text, "signal") and _writes(text, ("value",))
    return _asks_named(found, "signal", ("value",))


def source_of(message: Mapping[str, Any], longest: int) -> str | None:
    """Return the source that a message of a stream client names; None: no valid one."""
    for value in _every(_parsed(_text_in(message)), "source"):
        if isinstance(value, str) and 0 < len(value) <= longest and value.isprintable():
            return value
    return None


def members_of(message: Mapping[str, Any]) -> dict[str, Any]:
    """Return the first of the members of each name of a message that is invalid for us.

    Of text that is no JSON, these are those by which a call is answered, as far as they are there.
    """
    text = _text_in(message)
    found = _parsed(text)
    if found is None:
        found = tuple((name, json.loads(value)) for name, value in _WRITTEN.findall(text))
    members: _Members = found if isinstance(found, tuple) else ()
    return {name: _encodable(value) for name, value in reversed(members)}


_WRITTEN = re.compile(
    r'"(op|service|id)"\s*+:\s*+("[^"\\\x00-\x1f]*+"|-?[1-9][0-9]{0,17}(?![\w.]))'
)


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
    text = _text_in(message)
    found = _parsed(text)
    if found is None:
        return _names_estop(text, "topic") and _writes(text, STOP_FIELDS)
    return _asks_named(found, "topic", STOP_FIELDS)


def may_ask_rosbridge(text: str) -> bool:
    """Tell, without parsing a text, whether it may publish what asks for a stop."""
    return ESTOP_SIGNAL in text and _writes(text, STOP_FIELDS)


def _text_of(raw: bytes) -> str:
    """Return bytes as text; of UTF-16, which some shells write, every second one is 0."""
    return raw.decode("utf-8-sig", "replace").replace("\0", "").lstrip("\ufffd")


def _text_in(message: Mapping[str, Any]) -> str:
    """Return the text of an ASGI message, also if it was sent as binary."""
    text = message.get("text")
    return text if isinstance(text, str) else _text_of(bytes(message.get("bytes") or b""))


def _parsed(text: str) -> object | None:
    """Return JSON with objects as tuples of all their members; None: it is no JSON, or large."""
    if sum(map(text.count, "{[:")) > _MOST_MARKS:
        return None
    try:
        found: object = json.loads(text, object_pairs_hook=tuple, parse_int=_whole)
    except (ValueError, RecursionError):
        return None
    return found


def _whole(text: str) -> int | float:
    """Return a whole number; one with too many digits for Python as a float."""
    return int(text) if len(text) <= _MOST_DIGITS else float(text)


def _asks_in(found: object, member: str) -> bool:
    """Tell whether a member of this name asks for a stop, by its value or by a field in that."""
    waiting: list[tuple[object, bool]] = [(found, False)]
    while waiting:
        item, is_within = waiting.pop()
        names = (member, *STOP_FIELDS) if is_within else (member,)
        if any(map(asks_for_stop, _every(item, *names))):
            return True
        # An array is a list, so only objects are tuples.
        if isinstance(item, tuple):
            waiting += [(value, is_within or _bare(name) == member) for name, value in item]
        elif isinstance(item, list):
            waiting += [(value, is_within) for value in item]
    return False


def _asks_named(found: object, member: str, fields: tuple[str, ...]) -> bool:
    """Tell whether an object whose member names the e-stop asks for a stop, or one within it."""
    waiting: list[tuple[object, bool]] = [(found, False)]
    while waiting:
        item, is_within = waiting.pop()
        is_estop = is_within or any(
            isinstance(value, str) and signal_name(value) == ESTOP_SIGNAL
            for value in _every(item, member)
        )
        if is_estop and any(map(asks_for_stop, _every(item, *fields))):
            return True
        if isinstance(item, tuple):
            waiting += [(value, is_estop) for _, value in item]
        elif isinstance(item, list):
            waiting += [(value, is_estop) for value in item]
    return False


def _every(found: object, *names: str) -> Iterable[Any]:
    """Yield the values of all members of an object with one of these names."""
    members: _Members = found if isinstance(found, tuple) else ()
    return (value for name, value in members if _bare(name) in names)


def _bare(name: str) -> str:
    return signal_name(name).lower()


def _names_estop(text: str, member: str) -> bool:
    return re.search(rf"{member}[\"']?\s*+:\s*+[\"']/*+{ESTOP_SIGNAL}[\"']", text) is not None


def _writes(text: str, members: tuple[str, ...]) -> bool:
    """Tell whether a text gives one of the members a value that asks for a stop.

    Nothing is tried twice (`*+`), so that the time is linear whatever the text is.
    """
    pattern = (
        rf"\b(?:{'|'.join(members)})[\"']?\s*+[:=]\s*+[\"']?\s*+"
        r"(?:true|yes|on|1(?:\.0*+)?)(?![\w.])"
    )
    return re.search(pattern, text, re.IGNORECASE) is not None
