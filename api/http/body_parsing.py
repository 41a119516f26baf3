"""Request bodies: reading up to a limit, strict parsing, validation, and their faults.

The routes and the worker process share this, so it uses no web framework.
"""

import json
from collections.abc import AsyncIterable, Iterable, Mapping, Sequence
from itertools import islice
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from api.http.schemas.problem import BodyFault
from domain.errors import PilothouseError, shortened

MAX_FAULTS = 20
"""Faults that an answer lists; whoever sent 24,000 of them needs no answer of 2 MB."""

MAX_MEMBERS = 1_000
"""Members of all objects in a body that is validated on the event loop, about 5 ms of work."""

_MAX_OBJECTS = 2 * MAX_MEMBERS
"""Opening braces in such a body: members that occur twice are found object by object in Python."""

_MAX_MARKS = 10_000
"""Braces and colons in such a body; that of a member may also be in a text."""

INVALID_QUERY = "INVALID_QUERY"
"""The code of an error in the query, where that of one in the body is `INVALID_BODY`."""

_MAX_MESSAGE = 500
_CONTAINERS = (dict, list)

AnyBody = TypeVar("AnyBody", bound=BaseModel)


class MalformedBodyError(PilothouseError):
    """A body that cannot be parsed."""

    code = "MALFORMED"


class BodyTooLargeError(PilothouseError):
    """A body that is larger than the limit."""

    code = "TOO_LARGE"

    def __init__(self, limit: int, start: bytes = b"") -> None:
        """Say what the limit is.

        Args:
            limit: Most bytes.
            start: What was read of the body.
        """
        super().__init__(f"the body is larger than {limit} bytes")
        self.start = start


class InvalidBodyError(PilothouseError):
    """A request that can be parsed and is invalid; `faults` lists the first of its faults."""

    code = "INVALID_BODY"

    def __init__(
        self,
        faults: Sequence[BodyFault],
        code: str | None = None,
        hint: str | None = None,
        count: int | None = None,
    ) -> None:
        """List at most `MAX_FAULTS` faults.

        Args:
            faults: The first ones, at least one.
            code: Of the error; None: `INVALID_BODY`.
            hint: What to do.
            count: Number of all faults; None: `faults` has all.
        """
        first = faults[0]
        place = f"{first.pointer}: " if first.pointer else ""
        others = (len(faults) if count is None else count) - 1
        more = f" (and {others} more)" if others else ""
        super().__init__(f"{place}{first.message}{more}")
        self.faults = tuple(faults[:MAX_FAULTS])
        if code is not None:
            self.code = code
        if hint is not None:
            self.hint = hint

    @classmethod
    def at(cls, pointer: str, error: PilothouseError) -> "InvalidBodyError":
        """Return the error for one member of a body.

        Args:
            pointer: The key of the member, or a JSON pointer.
            error: The error that was raised for it.
        """
        fault = BodyFault(pointer=as_pointer(pointer), code=error.code, message=error.message)
        return cls([fault], error.code, error.hint)


async def read_limited(chunks: AsyncIterable[bytes], limit: int) -> bytes:
    """Read a body; its length is checked while reading, since it may not be known before.

    Raises:
        BodyTooLargeError: It is longer than `limit` bytes.
    """
    body = bytearray()
    async for chunk in chunks:
        body += chunk
        if len(body) > limit:
            raise BodyTooLargeError(limit, bytes(body[:limit]))
    return bytes(body)


def parse_text(raw: bytes) -> str:
    """Return a body as text.

    Raises:
        MalformedBodyError: It is not UTF-8.
    """
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise MalformedBodyError(f"the body is not UTF-8: {error.reason}") from error


def parse_json(raw: bytes) -> object:
    """Parse a JSON text.

    Raises:
        MalformedBodyError: It is not JSON, is nested too deeply, has a member twice, or holds a
            lone surrogate, which cannot be encoded.
    """
    text = parse_text(raw)
    try:
        value: object = json.loads(text, object_pairs_hook=_unique)
        if "\\u" in text:
            json.dumps(value, ensure_ascii=False).encode()
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise MalformedBodyError(f"the body is not JSON: {error.msg} at {where}") from error
    except UnicodeEncodeError as error:
        raise MalformedBodyError("the body contains half a surrogate pair") from error
    except RecursionError as error:
        raise MalformedBodyError("the body is nested too deeply") from error
    except ValueError as error:
        raise MalformedBodyError("the body contains a number with too many digits") from error
    return value


def _unique(members: list[tuple[str, object]]) -> dict[str, object]:
    """Return an object; readers differ in which of two members of the same name they take.

    Raises:
        MalformedBodyError: A name occurs twice.
    """
    found = dict(members)
    if len(found) < len(members):
        left = iter(found)
        # A dictionary has its keys in the order in which they first occurred.
        twice = next(name for name, _ in members if name != next(left, None))
        raise MalformedBodyError(f"the body has the member {shortened(twice)!r} twice")
    return found


def parse_body(kind: type[AnyBody], raw: bytes) -> AnyBody:
    """Return a JSON text as a `kind`.

    Raises:
        MalformedBodyError: It is not JSON.
        InvalidBodyError: It is not a `kind`.
    """
    return check_body(kind, parse_json(raw))


def check_body(kind: type[AnyBody], value: object) -> AnyBody:
    """Validate a parsed JSON text as a `kind`.

    Raises:
        InvalidBodyError: It is not a `kind`.
    """
    try:
        return kind.model_validate(value)
    except ValidationError as error:
        faults = faults_of(error.errors(include_url=False))
        raise InvalidBodyError(faults, count=error.error_count()) from error


def parse_small(raw: bytes) -> object:
    """Parse a JSON text that is then validated on the event loop.

    Raises:
        MalformedBodyError: It is not JSON.
        InvalidBodyError: It has too many members, or objects, to be validated at once.
    """
    # Counted first, since parsing 80,000 empty objects would take longer than all the rest.
    objects = raw.count(b"{")
    if objects > _MAX_OBJECTS or objects + raw.count(b":") > _MAX_MARKS:
        raise _too_many_members()
    value = parse_json(raw)
    require_few_members(value)
    return value


def require_few_members(value: object) -> None:
    """Check the size of a parsed body before it is validated.

    Raises:
        InvalidBodyError: It has more than `MAX_MEMBERS` members of objects, or as many objects and
            arrays within arrays. Plain items, such as a thousand numbers, take little time.
    """
    members = nested = 0
    waiting = [value]
    while waiting:
        found = waiting.pop()
        if isinstance(found, dict):
            members += len(found)
            waiting += found.values()
        elif isinstance(found, list):
            inner = [item for item in found if type(item) in _CONTAINERS]
            nested += len(inner)
            waiting += inner
        if max(members, nested) > MAX_MEMBERS:
            raise _too_many_members()


def _too_many_members() -> InvalidBodyError:
    message = f"the body has more than {MAX_MEMBERS} members"
    return InvalidBodyError([BodyFault(pointer="", code="TOO_MANY_MEMBERS", message=message)])


def faults_of(
    errors: Iterable[Mapping[str, Any]], outside: frozenset[str] = frozenset()
) -> list[BodyFault]:
    """Convert the first `MAX_FAULTS` findings of pydantic.

    Args:
        errors: From `ValidationError.errors()`.
        outside: First items of a location that are not in the body, such as `body` and `query` of
            FastAPI.
    """
    faults = []
    for error in islice(errors, MAX_FAULTS):
        place = tuple(error["loc"])
        message = error["msg"]
        if place and place[0] in outside:
            source, place = place[0], place[1:]
            if source != "body":
                message, place = f"{source} {'.'.join(map(str, place))}: {message}", ()
        faults.append(
            BodyFault(
                pointer=pointer_to(*place),
                code=error["type"].upper(),
                message=shortened(message, _MAX_MESSAGE),
            )
        )
    return faults


def as_pointer(name: str) -> str:
    """Return the name of a member as a JSON pointer (RFC 6901); a pointer is returned as it is."""
    return name if not name or name.startswith("/") else pointer_to(name)


def pointer_to(*keys: str | int) -> str:
    """Return the JSON pointer (RFC 6901) that leads along `keys`; long keys are cut."""
    short = (shortened(str(key)) for key in keys)
    return "".join(f"/{key.replace('~', '~0').replace('/', '~1')}" for key in short)
