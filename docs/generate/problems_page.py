"""Problems: every code that an answer can carry, from the error tree and its table of statuses."""

from collections.abc import Iterator

from api.http.problems import STATUS_OF
from docs.generate.markdown import code, joined, page, table
from docs.generate.source_scan import codes_given_to, require_described

# What has no class of its own, since only HTTP can get it wrong.
_ONLY_HTTP = {
    "FAILED": (409, "Of a request in a scenario: it was answered with an object that failed."),
    "FOREIGN_ORIGIN": (403, "A write, or a WebSocket, from a page of another origin."),
    "HOST_NOT_ALLOWED": (403, "The name in `Host` is none of this service."),
    "INVALID_QUERY": (422, "A parameter in the address has a value that cannot be."),
    "METHOD_NOT_ALLOWED": (405, "`Allow` says what can be done there."),
    "NOT_READY": (503, "`/readyz`: no model, or the core does not tick."),
    "NO_MOCK": (404, "Signals are not mocked."),
    "TOO_MANY_REQUESTS": (429, "More requests a second than one address may send."),
    "UNKNOWN_PATH": (404, "There is nothing at this path."),
    "UNSUPPORTED_TYPE": (415, "A page sends a body that is not JSON, YAML or CSV."),
}
# Where the words of a class are for who reads the source.
_IN_OTHER_WORDS = {
    "INTERNAL": "A fault in Pilothouse; its log tells more.",
    "INVALID_BODY": "A body that can be read, and says something that cannot be; see `errors`.",
    "INVALID_WAYPOINTS": "A waypoint file with faults; see `findings`.",
}
# Not written out where they are given: named after the status, or of the framework.
_NOT_IN_SOURCE = {
    "INVALID_QUERY",
    "METHOD_NOT_ALLOWED",
    "TOO_MANY_REQUESTS",
    "UNKNOWN_PATH",
}

_INTRODUCTION = """\
What is refused or fails is answered with `application/problem+json` (RFC 9457): `type`, `title`,
`status`, `detail`, `instance`, and

| member | what it says |
|---|---|
| `code` | stable; the tables below |
| `hint` | what to do about it, where that is known |
| `blockers` | what stands against a change ([blockers](blockers.md)) |
| `available` | what could be asked instead |
| `errors` | `pointer`, `code` and `message` of each fault in a body |
| `findings` | what is wrong with a model or a file of waypoints ([findings](findings.md)) |

A refusal changes nothing. On the stream the same document comes as a frame of type `problem`."""


def problems_page() -> str:
    """Return the page `problems.md`.

    Raises:
        UndescribedError: A code is given in the source and not described here, or the reverse.
    """
    classes = {error.code for error in STATUS_OF}
    given = codes_given_to("make_problem", "HttpError") | _NOT_IN_SOURCE
    require_described("problems that only HTTP has", given - classes, set(_ONLY_HTTP))
    of_http = {(name, status, about) for name, (status, about) in _ONLY_HTTP.items()}
    rows = sorted({*_of_classes(), *of_http}, key=lambda row: (row[1], row[0]))
    shown = ((code(name), str(status), about) for name, status, about in rows)
    return page("Problems", _INTRODUCTION, table(("code", "status", "meaning"), shown))


def _of_classes() -> Iterator[tuple[str, int, str]]:
    for error, status in STATUS_OF.items():
        about = joined((error.__doc__ or "").partition("\n\n")[0])
        yield error.code, status.value, _IN_OTHER_WORDS.get(error.code, about)
