"""Blocking HTTP requests to a running service, for commands.

Only the HTTP interface is used, so commands work with any service that can be reached.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from urllib.parse import quote

import httpx

from api.client.address import Address
from api.client.outcomes import (
    Json,
    NoAnswerError,
    ServiceProblemError,
    no_connection,
    token_hint,
)

_DURABLE = "Pilothouse-Durable"
_KINDS = ("systems", "nodes")
_MOST_LISTED = 20
"""Parts of a kind in a hint."""
_TIMEOUT = httpx.Timeout(10.0, connect=3.0)


class ServiceClient:
    """Sends requests to a running service."""

    def __init__(self, address: Address, transport: httpx.BaseTransport | None = None) -> None:
        """Prepare to connect; nothing is sent yet.

        Args:
            address: URL of the service, and the token that is sent with each request.
            transport: Sends the requests; None: over the network.
        """
        self.address = address
        """URL of the service, and the token."""
        self._is_volatile = False
        self._http = httpx.Client(
            base_url=address.url,
            timeout=_TIMEOUT,
            # A proxy set in the environment cannot reach this machine.
            trust_env=address.loopback is None,
            transport=transport,
            headers=address.headers,
        )

    def close(self) -> None:
        """Close the connection."""
        self._http.close()

    def path_of(self, part: str) -> str:
        """Return the URL path of a system or node; a leading slash of its name is left out.

        Raises:
            ServiceProblemError: There is no such part.
            NoAnswerError: The service did not answer.
        """
        name = part.lstrip("/")
        problem: Json = {}
        for kind in _KINDS:
            path = f"/{kind}/{quote(name)}"
            try:
                self.call("GET", path)
            except ServiceProblemError as error:
                problem = error.problem
                if problem.get("code") != "UNKNOWN_PART":
                    raise
            else:
                return path
        detail = f"there is no system or node {name!r}"
        raise ServiceProblemError({**problem, "detail": detail, "hint": self._parts_like(name)})

    def _parts_like(self, name: str) -> str:
        """Return what may have been meant: the parts that there are, and the nearest of them."""
        known = {
            kind: [str(item["name"]) for item in self.call("GET", f"/{kind}")["items"]]
            for kind in _KINDS
        }
        lists = "; ".join(f"{kind}: {_some_of(names)}" for kind, names in known.items() if names)
        near = get_close_matches(name, [each for names in known.values() for each in names], n=1)
        return lists + (f"; did you mean {near[0]}?" if near else "")

    def call(
        self,
        method: str,
        path: str,
        body: Json | None = None,
        *,
        csv: str | None = None,
        query: Mapping[str, str | int | float] | None = None,
    ) -> Json:
        """Send a request and return the JSON object of the response; without content, an empty one.

        Args:
            method: HTTP method, such as `GET`.
            path: URL path, such as `/tasks`.
            body: Request body, sent as JSON.
            csv: Request body, sent as CSV instead of `body`.
            query: Query parameters.

        Raises:
            ServiceProblemError: The request was rejected.
            NoAnswerError: There was no response, or not in JSON; whether the request had an effect
                is unknown.
        """
        url = self.address.url
        try:
            content = None if csv is None else csv.encode()
            headers = {} if csv is None else {"Content-Type": "text/csv"}
            response = self._http.request(
                method, path, json=body, content=content, headers=headers, params=query or None
            )
        except httpx.ConnectError as error:
            raise no_connection(url, error) from error
        except httpx.HTTPError as error:
            raise NoAnswerError(f"no answer from {url}: {error}") from error
        self._is_volatile |= response.headers.get(_DURABLE) == "false"
        if response.status_code == httpx.codes.NO_CONTENT:
            return {}
        try:
            answer = response.json()
        except ValueError:
            answer = None
        if not isinstance(answer, dict):
            raise NoAnswerError(f"what answers at {url} is not Pilothouse")
        if response.status_code == httpx.codes.UNAUTHORIZED:
            answer["hint"] = token_hint(given=self.address.token is not None)
        if response.is_error:
            raise ServiceProblemError(answer)
        return answer

    def why_forgotten(self) -> str:
        """Return why a restart of the service would forget what was asked of it.

        Empty: it would not, or the service was told to store nothing.

        Raises:
            ServiceProblemError: The service denied access.
            NoAnswerError: The service did not answer.
        """
        if not self._is_volatile:
            return ""
        return str(self.call("GET", "/storage")["reason"] or "")


def _some_of(names: Sequence[str]) -> str:
    return ", ".join(names[:_MOST_LISTED]) + (", ..." if len(names) > _MOST_LISTED else "")


@contextmanager
def service_at(url: str) -> Iterator[ServiceClient]:
    """Return a client with the token set in the environment; the context closes it.

    Raises:
        NoAnswerError: `url` is not a valid HTTP or HTTPS URL, or the token is invalid.
    """
    client = ServiceClient(Address.with_token_of_environment(url))
    try:
        yield client
    finally:
        client.close()
