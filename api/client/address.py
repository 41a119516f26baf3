"""The address of a service, of its stream, and the token for them."""

import os
from dataclasses import dataclass, field
from urllib.parse import urlencode, urlsplit

from api.access_token import InvalidTokenError, read_token
from api.client.outcomes import NoAnswerError

_LOOPBACK = frozenset({"127.0.0.1", "::1", "localhost"})


@dataclass(frozen=True, slots=True)
class Address:
    """The address of a service, and the token for it."""

    url: str
    """Without a slash at the end."""
    token: str | None = field(default=None, repr=False)
    """None: requests carry no token."""

    @classmethod
    def of(cls, url: str, token: str | None = None) -> "Address":
        """Return the address of a service.

        Args:
            url: For example `http://127.0.0.1:8000`.
            token: None: requests carry no token.

        Raises:
            NoAnswerError: `url` is not the address of a web server.
        """
        try:
            parts = urlsplit(url)
            is_one = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0
        except ValueError:
            is_one = False
        if not is_one:
            raise NoAnswerError(f"invalid address {url!r}; an example is http://127.0.0.1:8000")
        return cls(url.rstrip("/"), token)

    @classmethod
    def with_token_of_environment(cls, url: str) -> "Address":
        """Return the address of a service, with the token from the environment.

        Raises:
            NoAnswerError: `url` is not the address of a web server, or the token is invalid.
        """
        try:
            return cls.of(url, read_token(os.environ))
        except InvalidTokenError as error:
            raise NoAnswerError(str(error)) from error

    @property
    def headers(self) -> dict[str, str]:
        """Return the headers of each request and of the handshake of the stream."""
        return {} if self.token is None else {"Authorization": f"Bearer {self.token}"}

    @property
    def loopback(self) -> tuple[str, int] | None:
        """Return host and port if the service is on this machine; else None."""
        parts = urlsplit(self.url)
        if parts.hostname not in _LOOPBACK:
            return None
        return parts.hostname, parts.port or (443 if parts.scheme == "https" else 80)

    def stream_url(self, epoch: str | None, last_event_id: int) -> str:
        """Return the address of the stream.

        Args:
            epoch: Of the known events; None: none is known.
            last_event_id: Of the newest known event.
        """
        known = {} if epoch is None else {"after": last_event_id, "epoch": epoch}
        return f"{self.url.replace('http', 'ws', 1)}/ws?{urlencode(known)}".rstrip("?")
