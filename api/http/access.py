"""Who may use the service: whoever has its token, or everybody where none is set."""

import hashlib
import hmac
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Self

from domain.errors import PilothouseError

if TYPE_CHECKING:
    # Not at run time: the command line reads its token here, and needs no web framework.
    from starlette.datastructures import Headers

TOKEN_VARIABLE = "PILOTHOUSE_TOKEN"
FILE_VARIABLE = "PILOTHOUSE_TOKEN_FILE"

MIN_GOOD_CHARACTERS = 16
"""A shorter token can be guessed by who tries for long."""

_MAX_CHARACTERS = 4_096
_SCHEME = "bearer"


class InvalidTokenError(Exception):
    """The token in the environment cannot be used; the message says why, and never holds it."""


class UnauthorizedError(PilothouseError):
    """A client that has not given the token of the service."""

    code = "UNAUTHORIZED"


@dataclass(frozen=True, slots=True)
class Access:
    """Whom the service lets in. It keeps a digest, so that nothing can show the token itself."""

    _digest: bytes | None = field(default=None, repr=False)

    @classmethod
    def open(cls) -> Self:
        """Let everybody in."""
        return cls()

    @classmethod
    def with_token(cls, token: str) -> Self:
        """Let in who gives `token`."""
        return cls(_digest_of(token))

    @property
    def required(self) -> bool:
        """Tell whether a token has to be given."""
        return self._digest is not None

    def accepts(self, token: str) -> bool:
        """Tell whether `token` lets in; how long that takes tells nothing about the right one."""
        return self._digest is None or hmac.compare_digest(_digest_of(token), self._digest)

    def accepts_header(self, headers: "Headers") -> bool:
        """Tell whether the headers of a request or of a handshake let in.

        Args:
            headers: With `Authorization: Bearer TOKEN`, if the client sends one.
        """
        token = bearer_of(headers)
        return self._digest is None or (token is not None and self.accepts(token))


def bearer_of(headers: "Headers") -> str | None:
    """Return the token that headers carry; None: none, two, or something else than a token."""
    given = headers.getlist("authorization")
    if len(given) != 1:
        return None
    scheme, _, token = given[0].strip().partition(" ")
    return token.strip() if scheme.lower() == _SCHEME and token.strip() else None


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


def _digest_of(token: str) -> bytes:
    # A message may hold half a surrogate pair, which is not the right token either.
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).digest()
