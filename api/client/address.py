"""The address of a service: its URL, the URL of its stream, and the access token."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from urllib.parse import urlencode, urlsplit

from api.access_token import InvalidTokenError, read_token
from api.client.outcomes import NoAnswerError

_LOOPBACK = frozenset({"127.0.0.1", "::1", "localhost"})


@dataclass(frozen=True, slots=True)
class Address:
    """The URL of a service, and the token that gives access to it."""

    url: str
    """Base URL, without a trailing slash."""
    token: str | None = field(default=None, repr=False)
    """Access token; None: requests are sent without one."""

    @classmethod
    def of(cls, url: str, token: str | None = None) -> "Address":
        """Return the address for a URL.

        Args:
            url: Base URL, such as `http://127.0.0.1:8000`.
            token: Access token; None: requests are sent without one.

        Raises:
            NoAnswerError: `url` is not a valid HTTP or HTTPS URL.
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
        """Return the address for a URL, with the access token set in the environment.

        Raises:
            NoAnswerError: `url` is not a valid HTTP or HTTPS URL, or the token is invalid.
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
        """Return host and port if the service is on this machine, so past any proxy; else None."""
        parts = urlsplit(self.url)
        if parts.hostname not in _LOOPBACK:
            return None
        return parts.hostname, parts.port or (443 if parts.scheme == "https" else 80)

    def stream_url(self, topics: Sequence[str], epoch: str | None, last_event_id: int) -> str:
        """Return the URL of the stream.

        Args:
            topics: Topics to subscribe to; empty: all.
            epoch: Epoch of the events received so far; None: none were received.
            last_event_id: Id of the newest of these events.
        """
        query: dict[str, str | int] = {"topics": ",".join(topics)} if topics else {}
        if epoch is not None:
            query |= {"after": last_event_id, "epoch": epoch}
        url = f"{self.url.replace('http', 'ws', 1)}/ws"
        return f"{url}?{urlencode(query, safe=',')}" if query else url
