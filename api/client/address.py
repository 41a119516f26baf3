"""Where a service is, how its stream is reached, and the token that opens it."""

import os
from dataclasses import dataclass, field
from urllib.parse import urlencode, urlsplit

from api.access_token import InvalidTokenError, read_token
from api.client.outcomes import NoAnswerError

_LOOPBACK = frozenset({"127.0.0.1", "::1", "localhost"})


@dataclass(frozen=True, slots=True)
class Address:
    """A service, and what it lets in by."""

    url: str
    """Without a slash at the end."""
    token: str | None = field(default=None, repr=False)
    """None: it is asked without one."""

    @classmethod
    def of(cls, url: str, token: str | None = None) -> "Address":
        """Return the address that somebody gave.

        Args:
            url: As in `http://127.0.0.1:8000`.
            token: None: the service is asked without one.

        Raises:
            NoAnswerError: `url` is no address of a web server.
        """
        try:
            parts = urlsplit(url)
            is_one = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0
        except ValueError:
            is_one = False
        if not is_one:
            raise NoAnswerError(f"{url!r} is no address such as http://127.0.0.1:8000")
        return cls(url.rstrip("/"), token)

    @classmethod
    def with_token_of_environment(cls, url: str) -> "Address":
        """Return the address that somebody gave, with the token of this process's environment.

        Raises:
            NoAnswerError: `url` is no address of a web server, or the token cannot be used.
        """
        try:
            return cls.of(url, read_token(os.environ))
        except InvalidTokenError as error:
            raise NoAnswerError(str(error)) from error

    @property
    def headers(self) -> dict[str, str]:
        """Return what each request and the handshake of the stream carry."""
        return {} if self.token is None else {"Authorization": f"Bearer {self.token}"}

    @property
    def loopback(self) -> tuple[str, int] | None:
        """Return host and port if they are on this machine, where no proxy leads to; else None."""
        parts = urlsplit(self.url)
        if parts.hostname not in _LOOPBACK:
            return None
        return parts.hostname, parts.port or (443 if parts.scheme == "https" else 80)

    def stream_url(self, epoch: str | None, last_event_id: int) -> str:
        """Return the address of the stream.

        Args:
            epoch: Of the events that are known; None: none is.
            last_event_id: Of these, the newest.
        """
        known = {} if epoch is None else {"after": last_event_id, "epoch": epoch}
        return f"{self.url.replace('http', 'ws', 1)}/ws?{urlencode(known)}".rstrip("?")
