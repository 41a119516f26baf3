"""Access to the service: with its token, or for everybody if none is set."""

import hashlib
import hmac
from dataclasses import dataclass, field
from typing import Self

from starlette.datastructures import Headers

from domain.errors import PilothouseError

MIN_GOOD_CHARACTERS = 16
"""A shorter token can be guessed by brute force."""

READS_ONLY = "pilothouse.reads_only"
"""In the scope of a WebSocket: whether its client may only read."""

_SCHEME = "bearer"


class UnauthorizedError(PilothouseError):
    """A client that has not sent the token of the service."""

    code = "UNAUTHORIZED"


class ReadsOnlyError(PilothouseError):
    """A write over a WebSocket from a page of an allowed origin, to a service without a token."""

    code = "READS_ONLY"

    def __init__(self) -> None:
        super().__init__("a page of another origin may only read: the service has no token")
        self.hint = "start the service with a token, PILOTHOUSE_TOKEN, and send it"


@dataclass(frozen=True, slots=True)
class Access:
    """The access control. Only a digest is kept, so that nothing can reveal the token itself."""

    _digest: bytes | None = field(default=None, repr=False)

    @classmethod
    def open(cls) -> Self:
        """Give everybody access."""
        return cls()

    @classmethod
    def with_token(cls, token: str) -> Self:
        """Give access to clients that send `token`."""
        return cls(_digest_of(token))

    @property
    def required(self) -> bool:
        """Tell whether a token is required."""
        return self._digest is not None

    def accepts(self, token: str) -> bool:
        """Tell whether `token` is correct; the comparison takes constant time."""
        return self._digest is None or hmac.compare_digest(_digest_of(token), self._digest)

    def accepts_header(self, headers: Headers) -> bool:
        """Tell whether the headers of a request or handshake give access.

        Args:
            headers: With `Authorization: Bearer TOKEN`, if the client sends a token.
        """
        token = bearer_of(headers)
        return self._digest is None or (token is not None and self.accepts(token))


def bearer_of(headers: Headers) -> str | None:
    """Return the token in the headers; None: there is none, several, or an invalid one."""
    given = headers.getlist("authorization")
    if len(given) != 1:
        return None
    scheme, _, token = given[0].strip().partition(" ")
    return token.strip() if scheme.lower() == _SCHEME and token.strip() else None


def _digest_of(token: str) -> bytes:
    # A token in a message may hold a lone surrogate, which must not raise here.
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).digest()
