"""The token in the environment: what the service asks for, and what its clients send."""

import os
from collections.abc import Mapping

TOKEN_VARIABLE = "PILOTHOUSE_TOKEN"
FILE_VARIABLE = "PILOTHOUSE_TOKEN_FILE"

_MAX_CHARACTERS = 4_096


class InvalidTokenError(Exception):
    """The token in the environment cannot be used; the message says why, and never holds it."""


def read_token(environ: Mapping[str, str]) -> str | None:
    """Return the token of the environment, from its variable or from the file that one names.

    Args:
        environ: As `os.environ`; it is not changed.

    Returns:
        The token; None: neither variable is set.

    Raises:
        InvalidTokenError: Both are set, the file cannot be read, or what is there is no token.
    """
    token, file = environ.get(TOKEN_VARIABLE), environ.get(FILE_VARIABLE)
    if token is not None and file is not None:
        raise InvalidTokenError(f"{TOKEN_VARIABLE} and {FILE_VARIABLE} are both set: unset one")
    if token is not None:
        return _checked(token, TOKEN_VARIABLE)
    if file is not None:
        return _checked(_first_of(file), f"the file of {FILE_VARIABLE}")
    return None


def take_token() -> str | None:
    """Return the token of this process's environment, and remove its variable.

    So neither child processes nor a dump of the environment have it.

    Raises:
        InvalidTokenError: As of `read_token`.
    """
    try:
        return read_token(os.environ)
    finally:
        os.environ.pop(TOKEN_VARIABLE, None)


def _first_of(file: str) -> str:
    """Return the beginning of a file, without the line end that an editor leaves behind."""
    try:
        with open(file, "rb") as opened:
            raw = opened.read(_MAX_CHARACTERS + 3)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise InvalidTokenError(f"{FILE_VARIABLE}: cannot read {file}: {why}") from error
    text = raw.decode("latin-1")
    return text.removesuffix("\n").removesuffix("\r")


def _checked(token: str, place: str) -> str:
    """Return a token that can be sent in a header as it is."""
    if not token.strip():
        raise InvalidTokenError(f"there is no token in {place}: it is empty")
    if len(token) > _MAX_CHARACTERS:
        raise InvalidTokenError(
            f"the token in {place} has more than {_MAX_CHARACTERS} characters: that is no token"
        )
    if not all("!" <= character <= "~" for character in token):
        raise InvalidTokenError(
            f"the token in {place} has a space or a character that is not printable ASCII, which "
            "no header can carry"
        )
    return token
