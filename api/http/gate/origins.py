"""Origins of pages: which are ours, and which others are allowed (RFC 6454)."""

import re
from collections.abc import Iterable

_ORIGIN = re.compile(
    r"([a-z][a-z0-9+.-]*)://(\[[0-9a-f:.]+\]|[^\s:/?#@\[\]\\,*]+)(?::([0-9]{1,5}))?"
)
_DEFAULT_PORTS = {"http": "80", "https": "443"}


class InvalidOriginError(ValueError):
    """A text that is not an origin; the message says what one is."""

    def __init__(self, text: str) -> None:
        super().__init__(
            f"invalid origin {text!r}; expected a scheme, a host and perhaps a port, such as "
            "https://grafana.example:3000"
        )


class AllowedOrigins:
    """The other origins whose pages may read, and write with the token."""

    def __init__(self, origins: Iterable[str] = ()) -> None:
        """Read them.

        Raises:
            InvalidOriginError: One is not an origin. There is no wildcard.
        """
        self._origins = {_normal(origin) for origin in origins}

    def __bool__(self) -> bool:
        return bool(self._origins)

    def __contains__(self, origin: str) -> bool:
        """Tell whether the value of an `Origin` header is one of them."""
        try:
            return _normal(origin) in self._origins
        except InvalidOriginError:
            return False


def is_same_origin(origin: str, host: str) -> bool:
    """Tell whether a page of `origin` comes from the service at `host`.

    Schemes are not compared: behind a proxy with TLS, ours differs from that of the page.

    Args:
        origin: Value of the header, such as `https://robot.example` or `null`.
        host: Value of the header, such as `robot.example:8000`.
    """
    scheme = origin.partition(":")[0].lower()
    try:
        return scheme in _DEFAULT_PORTS and _normal(origin) == _normal(f"{scheme}://{host}")
    except InvalidOriginError:
        return False


def _normal(origin: str) -> str:
    """Return an origin in small letters and without its default port.

    Raises:
        InvalidOriginError: It is no origin, such as `null`, or more than one.
    """
    match = _ORIGIN.fullmatch(origin.strip().lower())
    if match is None:
        raise InvalidOriginError(origin)
    scheme, host, port = match.groups()
    return f"{scheme}://{host}:{port or _DEFAULT_PORTS.get(scheme, '')}"
