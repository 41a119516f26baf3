"""Bodies are read up to a limit and taken at their word."""

from collections.abc import AsyncIterator

import pytest

from api.http.body_parsing import (
    BodyTooLargeError,
    InvalidBodyError,
    MalformedBodyError,
    as_pointer,
    parse_body,
    parse_json,
    parse_text,
    pointer_to,
    read_limited,
)
from api.http.schemas.parts import ModeBody
from domain.errors import UnknownSignalError


async def in_chunks(*chunks: bytes) -> AsyncIterator[bytes]:
    for chunk in chunks:
        yield chunk


async def test_a_body_is_counted_while_it_comes_in() -> None:
    assert await read_limited(in_chunks(b"ab", b"cd"), 4) == b"abcd"
    with pytest.raises(BodyTooLargeError):
        await read_limited(in_chunks(b"ab", b"cd", b"e"), 4)


async def test_what_is_too_large_is_not_read_to_its_end() -> None:
    chunks = in_chunks(b"abc", b"def", b"ghi")

    with pytest.raises(BodyTooLargeError):
        await read_limited(chunks, 4)

    assert [chunk async for chunk in chunks] == [b"ghi"]


@pytest.mark.parametrize(
    "raw",
    [
        b"",
        b"{",
        b"{} {}",
        b"\xff",
        b'{"mode": "\\ud800"}',
        b'{"\\udfff": 1}',
        b"[" * 100_000,
        b'{"a":' * 100_000,
        b"1" * 5_000,
        b"{\x00}",
        '{"a": 1}'.encode("utf-16"),
    ],
)
def test_what_is_no_json_is_malformed_and_nothing_worse(raw: bytes) -> None:
    with pytest.raises(MalformedBodyError):
        parse_json(raw)


@pytest.mark.parametrize(
    ("raw", "value"),
    [
        (b"{}", {}),
        (b'\xef\xbb\xbf{"a": 1}', {"a": 1}),
        (b'"\\ud83d\\ude00"', "\N{GRINNING FACE}"),
        (b"1.0", 1.0),
    ],
)
def test_what_is_json_is_read(raw: bytes, value: object) -> None:
    assert parse_json(raw) == value


def test_what_is_no_text_is_malformed() -> None:
    with pytest.raises(MalformedBodyError, match="not UTF-8"):
        parse_text(b"\xfe")


def test_everything_that_is_wrong_is_told_at_once() -> None:
    with pytest.raises(InvalidBodyError) as raised:
        parse_body(ModeBody, b'{"mood": "FAST"}')

    assert [(fault.pointer, fault.code) for fault in raised.value.faults] == [
        ("/mode", "MISSING"),
        ("/mood", "EXTRA_FORBIDDEN"),
    ]


def test_an_error_keeps_its_code_and_hint_when_its_place_is_told() -> None:
    error = InvalidBodyError.at("mood", UnknownSignalError("signal", "mood", ["estop"]))

    assert (error.code, error.hint) == ("UNKNOWN_SIGNAL", "known: estop")
    assert [fault.pointer for fault in error.faults] == ["/mood"]


@pytest.mark.parametrize(
    ("keys", "pointer"), [((), ""), (("a", 0), "/a/0"), (("a/b~c",), "/a~1b~0c"), (("/x",), "/~1x")]
)
def test_keys_are_escaped_in_a_pointer(keys: tuple[str | int, ...], pointer: str) -> None:
    assert pointer_to(*keys) == pointer


def test_a_pointer_is_kept_and_a_name_becomes_one() -> None:
    assert (as_pointer("/stamp"), as_pointer("stamp"), as_pointer("")) == ("/stamp", "/stamp", "")
