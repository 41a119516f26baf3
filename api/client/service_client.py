"""The client behind `pilothouse mode`, `state` and `task`; asks for a change and follows it.

It needs nothing but the HTTP interface, so that it works against any service within reach.
"""

import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from enum import IntEnum
from typing import Any
from urllib.parse import SplitResult, quote, urlsplit

import httpx

from api.http.access import FILE_VARIABLE, TOKEN_VARIABLE, InvalidTokenError, read_token

_POLL_S = 0.1
_TIMEOUT = httpx.Timeout(10.0, connect=3.0)
_LOOPBACK = frozenset({"127.0.0.1", "::1", "localhost"})

_NO_TOKEN = f"set {TOKEN_VARIABLE} to the token of the service, or {FILE_VARIABLE} to its file"
_OTHER_TOKEN = f"the token in {TOKEN_VARIABLE} or {FILE_VARIABLE} is that of another service"

Json = Mapping[str, Any]


class Outcome(IntEnum):
    """How a change ended, as exit code of the command."""

    SUCCEEDED = 0
    FAILED = 1
    UNKNOWN = 2
    """Timed out, not ended yet, or nobody answered."""


class ServiceProblemError(Exception):
    """The service answered with a problem document (RFC 9457)."""

    def __init__(self, problem: Json) -> None:
        super().__init__(problem.get("detail") or problem.get("title") or "refused")
        self.problem = problem


class NoAnswerError(Exception):
    """The service did not answer, or something answered that is not Pilothouse."""


class ServiceClient:
    """A running service at `url`."""

    def __init__(
        self,
        url: str,
        transport: httpx.BaseTransport | None = None,
        token: str | None = None,
    ) -> None:
        """Prepare to talk to the service; nothing is sent yet.

        Args:
            url: Where the service runs, as in `http://127.0.0.1:8000`.
            transport: How requests are sent; None: over the network.
            token: Sent with each request; None: the service wants none.

        Raises:
            NoAnswerError: `url` is no address of a web server.
        """
        parts = split_address(url)
        self.url = url.rstrip("/")
        # A proxy of the environment does not lead back to this machine.
        trust_env = parts.hostname not in _LOOPBACK
        self._has_token = token is not None
        self._http = httpx.Client(
            base_url=self.url,
            timeout=_TIMEOUT,
            trust_env=trust_env,
            transport=transport,
            headers={} if token is None else {"Authorization": f"Bearer {token}"},
        )

    def close(self) -> None:
        """Close the connection."""
        self._http.close()

    def path_of(self, part: str) -> str:
        """Return the path of a system or node.

        Raises:
            ServiceProblemError: There is no such part.
            NoAnswerError: Nobody answered.
        """
        path = f"/systems/{quote(part)}"
        try:
            self.call("GET", path)
        except ServiceProblemError as error:
            if error.problem.get("status") != httpx.codes.NOT_FOUND:
                raise
            path = f"/nodes/{quote(part)}"
            self.call("GET", path)
        return path

    def call(
        self,
        method: str,
        path: str,
        body: Json | None = None,
        *,
        csv: str | None = None,
        query: Mapping[str, str | int | float] | None = None,
    ) -> Json:
        """Send one request and return the JSON object of the answer; without content, an empty one.

        Args:
            method: As in `GET`.
            path: As in `/tasks`.
            body: Sent as JSON.
            csv: Sent instead of `body`.
            query: What follows the path.

        Raises:
            ServiceProblemError: It was refused.
            NoAnswerError: Nobody answered, or not in JSON; whether it was done is not known.
        """
        try:
            content = None if csv is None else csv.encode()
            headers = {} if csv is None else {"Content-Type": "text/csv"}
            response = self._http.request(
                method, path, json=body, content=content, headers=headers, params=query or None
            )
        except httpx.ConnectError as error:
            raise NoAnswerError(f"no service answers at {self.url}: is it running?") from error
        except httpx.HTTPError as error:
            raise NoAnswerError(f"no answer from {self.url}: {error}") from error
        if response.status_code == httpx.codes.NO_CONTENT:
            return {}
        try:
            answer = response.json()
        except ValueError:
            answer = None
        if not isinstance(answer, dict):
            raise NoAnswerError(f"what answers at {self.url} is not Pilothouse")
        if response.status_code == httpx.codes.UNAUTHORIZED:
            answer["hint"] = token_hint(given=self._has_token)
        if response.is_error:
            raise ServiceProblemError(answer)
        return answer


def split_address(url: str) -> SplitResult:
    """Return the parts of the address of a web server.

    Raises:
        NoAnswerError: It is none.
    """
    try:
        parts = urlsplit(url)
        is_one = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0
    except ValueError:
        is_one = False
    if not is_one:
        raise NoAnswerError(f"{url!r} is no address such as http://127.0.0.1:8000")
    return parts


def token_hint(*, given: bool) -> str:
    """Say what to do about a service that wants a token, or another one than was given."""
    return _OTHER_TOKEN if given else _NO_TOKEN


@contextmanager
def service_at(url: str) -> Iterator[ServiceClient]:
    """Return a client with the token of the environment, closed at the end of the context.

    Raises:
        NoAnswerError: Nobody can be asked: the address is none, or the token cannot be used.
    """
    try:
        client = ServiceClient(url, token=read_token(os.environ))
    except InvalidTokenError as error:
        raise NoAnswerError(str(error)) from error
    try:
        yield client
    finally:
        client.close()


def show_plan(
    client: ServiceClient, part: str, what: str, request: Json, say: Callable[[str], None]
) -> Outcome:
    """Say which steps a change would take; nothing is changed.

    Args:
        client: Where to ask.
        part: System or node.
        what: `mode` or `state`.
        request: Body of the request.
        say: Takes a line for the user.

    Raises:
        ServiceProblemError: It would be refused.
        NoAnswerError: Nobody answered.
    """
    plan = client.call("POST", f"{client.path_of(part)}/{what}?dry_run=true", request)
    steps = plan["steps"]
    if not steps:
        say(f"{part} is there already: no step is needed")
    for step in steps:
        say(f"would {_words(step['action'])} {step['node']}")
    return Outcome.SUCCEEDED


def change(
    client: ServiceClient,
    part: str,
    what: str,
    request: Json,
    wait_s: float,
    say: Callable[[str], None],
    pause: Callable[[float], None] = time.sleep,
) -> Outcome:
    """Ask for a change, and say step by step what becomes of it.

    Args:
        client: Where to ask.
        part: System or node.
        what: `mode` or `state`.
        request: Body of the request.
        wait_s: How long the end is waited for.
        say: Takes a line for the user.
        pause: Waits for a number of seconds.

    Raises:
        ServiceProblemError: It was refused.
        NoAnswerError: Nobody answered; whether the change goes on is not known.
    """
    view = client.call("POST", f"{client.path_of(part)}/{what}", request)
    told: dict[tuple[str, int], str] = {}
    deadline = time.monotonic() + wait_s
    while True:
        for line in _news(view["steps"], told):
            say(line)
        if view["status"] != "running":
            break
        if time.monotonic() >= deadline:
            say(f"not ended within {wait_s:g} s; see {client.url}/changes/{view['id']}")
            return Outcome.UNKNOWN
        pause(_POLL_S)
        view = client.call("GET", f"/changes/{view['id']}")
    say(f"{part}: {_words(view['status'])}" + (f": {view['reason']}" if view["reason"] else ""))
    ends = {"succeeded": Outcome.SUCCEEDED, "timed_out": Outcome.UNKNOWN}
    return ends.get(view["status"], Outcome.FAILED)


def refusal_lines(problem: Json) -> Iterator[str]:
    """Say why something was refused, what stands against it, and what helps."""
    yield f"refused: {problem.get('detail') or problem.get('title')}"
    for blocker in problem.get("blockers") or ():
        yield f"  {blocker['code']}: {blocker['message']}{_way(blocker.get('path') or ())}"
    faults = problem.get("errors") or ()
    # A single fault is told by the detail already.
    for fault in faults if len(faults) > 1 else ():
        yield f"  {fault['pointer'] or 'body'}: {fault['message']}"
    if problem.get("hint"):
        yield f"  hint: {problem['hint']}"


def _way(path: Sequence[str]) -> str:
    return f" ({' > '.join(path)})" if len(path) > 1 else ""


def _news(steps: Sequence[Json], told: dict[tuple[str, int], str]) -> Iterator[str]:
    """Say what changed in the steps since the last time; a node's steps keep their order."""
    seen: dict[str, int] = {}
    for step in steps:
        number = seen[step["node"]] = seen.get(step["node"], 0) + 1
        key, status = (step["node"], number), step["status"]
        if status == "pending" or told.get(key) == status:
            continue
        told[key] = status
        error = f": {step['error']}" if step["error"] else ""
        ending = "..." if status == "running" else f": {_words(status)}{error}"
        yield f"{_words(step['action'])} {step['node']}{ending}"


def _words(label: str) -> str:
    return label.replace("_", " ")
