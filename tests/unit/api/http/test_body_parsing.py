"""Bodies are read up to a limit and taken at their word."""

from collections.abc import AsyncIterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from api.http import body_parsing
from api.http.body_parsing import (
    MAX_FAULTS,
    BodyTooLargeError,
    InvalidBodyError,
    MalformedBodyError,
    as_pointer,
    check_body,
    parse_body,
    parse_json,
    parse_small,
    parse_text,
    pointer_to,
    read_limited,
    require_few_members,
)
from api.http.schemas.health import EmergencyStopBody
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


# --- how much an answer says --------------------------------------------------------------------


@given(
    count=st.integers(1, 999),
    name=st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=3_000),
)
@settings(max_examples=25)
def test_an_answer_about_a_bad_body_is_short_whatever_was_sent(count: int, name: str) -> None:
    sent = {f"{name}{number}": number for number in range(count)}

    with pytest.raises(InvalidBodyError) as refused:
        # The required member is missing too.
        check_body(EmergencyStopBody, sent)

    faults = refused.value.faults
    assert len(faults) <= MAX_FAULTS
    assert all(len(fault.pointer) <= 410 and len(fault.message) <= 510 for fault in faults)
    assert f"and {count} more" in refused.value.message


def test_members_are_counted_at_every_depth() -> None:
    few = {"a": [{"b": number} for number in range(900)]}
    many = {"a": [{"b": {"c": number}} for number in range(900)]}

    require_few_members(few)
    with pytest.raises(InvalidBodyError, match="more than 1000 members"):
        require_few_members(many)


@pytest.mark.parametrize("items", [[{}] * 1_001, [[]] * 1_001, [[[]] * 500] * 3])
def test_objects_and_arrays_in_arrays_are_members(items: list[object]) -> None:
    with pytest.raises(InvalidBodyError, match="more than 1000 members"):
        require_few_members({"gains": items})


def test_what_is_too_much_is_refused_before_it_is_parsed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert parse_small(b'{"colons":"' + b":" * 9_000 + b'"}')

    monkeypatch.setattr(body_parsing, "parse_json", pytest.fail)
    for raw in (b"[" + b"{}," * 10_001, b'{"a"' + b":" * 10_000):
        with pytest.raises(InvalidBodyError, match="more than 1000 members"):
            parse_small(raw)


def test_long_lists_of_numbers_are_no_members() -> None:
    require_few_members({"gains": [1.0] * 100_000})


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ('{"a":1,"a":1}', "a"),
        ('{"a":1,"b":2,"a":3,"b":4}', "a"),
        ('{"x":[{"b":1,"c":2,"c":null}]}', "c"),
        ('{"a":1,"\\u0061":2}', "a"),
    ],
)
def test_a_member_that_occurs_twice_is_refused(text: str, name: str) -> None:
    with pytest.raises(MalformedBodyError, match=f"the body has the member '{name}' twice"):
        parse_json(text.encode())
