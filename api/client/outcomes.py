"""Outcomes of requests to a service: how a change ended, a rejection, or no answer."""

from collections.abc import Iterator, Mapping, Sequence
from enum import IntEnum
from typing import Any

from api.access_token import FILE_VARIABLE, TOKEN_VARIABLE

_NO_TOKEN = f"set {TOKEN_VARIABLE} to the token of the service, or {FILE_VARIABLE} to its file"
_OTHER_TOKEN = f"the token in {TOKEN_VARIABLE} or {FILE_VARIABLE} is that of another service"

Json = Mapping[str, Any]


class Outcome(IntEnum):
    """How a change or task ended; the exit code of a command."""

    SUCCEEDED = 0
    FAILED = 1
    UNKNOWN = 2
    """Timed out, not ended yet, or the service did not answer."""


class ServiceProblemError(Exception):
    """The service answered with a problem document (RFC 9457)."""

    def __init__(self, problem: Json) -> None:
        super().__init__(problem.get("detail") or problem.get("title") or "rejected")
        self.problem = problem


class NoAnswerError(Exception):
    """The service did not answer, or what answered is not Pilothouse."""


class NoConnectionError(NoAnswerError):
    """The service could not be connected to: it was sent nothing."""


def no_connection(url: str, error: Exception) -> NoConnectionError:
    """Return the error for a service that could not be connected to.

    Args:
        url: Its base URL.
        error: What the connection failed with.
    """
    words = str(error)
    if "CERTIFICATE_VERIFY_FAILED" in words:
        return NoConnectionError(f"the certificate of {url} is not trusted: {words}")
    if url.startswith("https:") and "SSL" in words:
        plain = url.replace("https:", "http:", 1)
        return NoConnectionError(f"what answers at {url} does not speak HTTPS; try {plain}")
    return NoConnectionError(f"no service answers at {url}: is it running?")


def token_hint(*, given: bool) -> str:
    """Return a hint for a request without a token, or with a token that was not accepted."""
    return _OTHER_TOKEN if given else _NO_TOKEN


def refusal_lines(problem: Json) -> Iterator[str]:
    """Yield why a request was rejected, with its blockers and a hint."""
    yield f"rejected: {problem.get('detail') or problem.get('title')}"
    for blocker in problem.get("blockers") or ():
        yield f"  {blocker['code']}: {blocker['message']}{_way(blocker.get('path') or ())}"
    faults = problem.get("errors") or ()
    # The detail of the problem already states a single fault.
    for fault in faults if len(faults) > 1 else ():
        yield f"  {fault['pointer'] or 'body'}: {fault['message']}"
    if problem.get("hint"):
        yield f"  hint: {problem['hint']}"


def _way(path: Sequence[str]) -> str:
    return f" ({' > '.join(path)})" if len(path) > 1 else ""
