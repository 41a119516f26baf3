import os
from pathlib import Path

import pytest

from api.access_token import (
    FILE_VARIABLE,
    TOKEN_VARIABLE,
    InvalidTokenError,
    read_token,
    take_token,
)

TOKEN = "correct-horse-battery"


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
