"""Who may use the service: whoever has its token, or everybody where none is set."""

import hashlib
import hmac
from dataclasses import dataclass, field
from typing import Self

from starlette.datastructures import Headers

from domain.errors import PilothouseError

MIN_GOOD_CHARACTERS = 16
"""A shorter token can be guessed by who tries for long."""

_SCHEME = "bearer"


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

    def accepts_header(self, headers: Headers) -> bool:
        """Tell whether the headers of a request or of a handshake let in.

        Args:
            headers: With `Authorization: Bearer TOKEN`, if the client sends one.
        """
        token = bearer_of(headers)
        return self._digest is None or (token is not None and self.accepts(token))


def bearer_of(headers: Headers) -> str | None:
    """Return the token that headers carry; None: none, two, or something else than a token."""
    given = headers.getlist("authorization")
    if len(given) != 1:
        return None
    scheme, _, token = given[0].strip().partition(" ")
    return token.strip() if scheme.lower() == _SCHEME and token.strip() else None


def _digest_of(token: str) -> bytes:
    # A message may hold half a surrogate pair, which is not the right token either.
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).digest()
