import os
from pathlib import Path

import pytest
from starlette.datastructures import Headers

from api.http.access import (
    FILE_VARIABLE,
    TOKEN_VARIABLE,
    Access,
    InvalidTokenError,
    bearer_of,
    read_token,
    take_token,
)

TOKEN = "correct-horse-battery"


def headers(*values: str) -> Headers:
    return Headers(raw=[(b"authorization", value.encode("latin-1")) for value in values])


# --- who is let in ------------------------------------------------------------------------------


def test_where_no_token_is_set_everybody_is_let_in() -> None:
    access = Access.open()

    assert not access.required
    assert access.accepts("")
    assert access.accepts_header(Headers())
    assert access.accepts_header(headers("Bearer whatever"))


@pytest.mark.parametrize(
    "wrong", ["", TOKEN[:-1], TOKEN + "x", TOKEN.upper(), f" {TOKEN}", "ä", "\ud800"]
)
def test_only_the_very_token_lets_in(wrong: str) -> None:
    access = Access.with_token(TOKEN)

    assert access.required
    assert access.accepts(TOKEN)
    assert not access.accepts(wrong)


@pytest.mark.parametrize(
    "given", [f"Bearer {TOKEN}", f"bearer {TOKEN}", f"BEARER  {TOKEN} ", f" Bearer {TOKEN}"]
)
def test_a_header_lets_in_however_its_scheme_is_written(given: str) -> None:
    assert Access.with_token(TOKEN).accepts_header(headers(given))


@pytest.mark.parametrize(
    "given",
    [
        (),
        ("",),
        (TOKEN,),
        ("Bearer",),
        ("Bearer ",),
        (f"Basic {TOKEN}",),
        ("Bearer wrong",),
        (f"Bearer {TOKEN}, Bearer {TOKEN}",),
        (f"Bearer {TOKEN}", f"Bearer {TOKEN}"),
        ("Bearer \xff",),
    ],
)
def test_a_header_that_says_it_otherwise_does_not(given: tuple[str, ...]) -> None:
    assert not Access.with_token(TOKEN).accepts_header(headers(*given))


def test_a_token_in_a_header_is_told_from_none() -> None:
    assert bearer_of(headers("Bearer wrong")) == "wrong"
    assert bearer_of(headers("Basic wrong")) is None


def test_nothing_shows_the_token() -> None:
    access = Access.with_token(TOKEN)

    assert TOKEN not in repr(access)
    assert "digest" not in repr(access)


# --- where it comes from ------------------------------------------------------------------------


def test_the_environment_need_not_have_a_token() -> None:
    assert read_token({}) is None


def test_the_token_is_in_a_variable() -> None:
    assert read_token({TOKEN_VARIABLE: TOKEN}) == TOKEN


@pytest.mark.parametrize("ending", ["", "\n", "\r\n"])
def test_or_in_a_file_whose_last_line_may_be_ended(ending: str, tmp_path: Path) -> None:
    file = tmp_path / "token"
    file.write_bytes(f"{TOKEN}{ending}".encode())

    assert read_token({FILE_VARIABLE: str(file)}) == TOKEN


@pytest.mark.parametrize(
    ("token", "why"),
    [
        ("", "it is empty"),
        (" \t", "it is empty"),
        ("a b", "a space"),
        ("a\x00b", "not printable"),
        ("schlüssel", "not printable"),
        ("two\nlines", "not printable"),
        ("x" * 4_097, "more than 4096"),
    ],
)
def test_what_is_no_token_is_refused_without_being_shown(
    token: str, why: str, tmp_path: Path
) -> None:
    file = tmp_path / "token"
    file.write_text(token)

    for environ in ({TOKEN_VARIABLE: token}, {FILE_VARIABLE: str(file)}):
        with pytest.raises(InvalidTokenError, match=why) as caught:
            read_token(environ)
        assert not token.strip() or token not in str(caught.value)


@pytest.mark.parametrize("file", ["nowhere", "", "."])
def test_a_file_that_cannot_be_read_is_named(file: str, tmp_path: Path) -> None:
    path = str(tmp_path / file) if file == "nowhere" else file

    with pytest.raises(InvalidTokenError, match=f"{FILE_VARIABLE}: cannot read"):
        read_token({FILE_VARIABLE: path})


def test_a_file_without_end_is_not_read_to_it() -> None:
    with pytest.raises(InvalidTokenError, match="more than 4096"):
        read_token({FILE_VARIABLE: "/dev/zero"})


def test_two_tokens_contradict_each_other() -> None:
    with pytest.raises(InvalidTokenError, match="both set"):
        read_token({TOKEN_VARIABLE: TOKEN, FILE_VARIABLE: "/run/secrets/token"})


def test_a_service_that_took_its_token_leaves_none_for_its_children(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(TOKEN_VARIABLE, TOKEN)

    assert take_token() == TOKEN
    assert TOKEN_VARIABLE not in os.environ
    assert take_token() is None


def test_nor_does_one_that_could_not_use_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(TOKEN_VARIABLE, "a b")

    with pytest.raises(InvalidTokenError):
        take_token()
    assert TOKEN_VARIABLE not in os.environ
