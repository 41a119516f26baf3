"""Problems: every code of a response, from the error tree and its table of HTTP statuses."""

from collections.abc import Iterator

from api.http.problems import STATUS_OF
from docs.generate.markdown import code, joined, page, table
from docs.generate.source_scan import codes_given_to, require_described

# These errors occur only in HTTP and have no class of their own.
_ONLY_HTTP = {
    "FAILED": (409, "A request of a scenario: the operation that it started failed."),
    "FOREIGN_ORIGIN": (403, "A request from a page of another origin that is not allowed."),
    "HEAD_TOO_LARGE": (431, "A request with too many headers, or too long ones."),
    "HOST_NOT_ALLOWED": (403, "The name in `Host` is not allowed."),
    "INVALID_QUERY": (
        422,
        "A query field with an invalid value; in a write also an unknown or a repeated one.",
    ),
    "MALFORMED_REQUEST": (400, "Not a valid HTTP/1.1 request; the connection is closed."),
    "METHOD_NOT_ALLOWED": (405, "`Allow` lists the allowed methods."),
    "NOT_READY": (503, "`/readyz`: no model, or the core does not tick."),
    "NO_HISTORY": (404, "The history of signals is not kept, as in a simulation."),
    "NO_MOCK": (404, "Signals are not mocked."),
    "NOT_SIMULATED": (409, "A fault for a node or a vehicle that is not simulated here."),
    "TOO_MANY_REQUESTS": (429, "More requests per second than one address may send."),
    "REPEATED_HEADER": (400, "A header that may occur once is there more than once."),
    "UNKNOWN_PATH": (404, "Nothing exists at this path."),
    "URI_TOO_LONG": (414, "The path and its query are too long."),
    "UNSUPPORTED_TYPE": (415, "A page sent a body that is not JSON, YAML or CSV."),
}
# Where the docstring of a class is meant for readers of the source.
_IN_OTHER_WORDS = {
    "INTERNAL": "An internal error in Pilothouse; see its log.",
    "INVALID_BODY": "A well-formed body with invalid content; see `errors`.",
    "INVALID_WAYPOINTS": "A waypoint file with errors; see `findings`.",
}
# Not found by the scan: named after the status, or raised by the framework.
_NOT_IN_SOURCE = {
    "INVALID_QUERY",
    "METHOD_NOT_ALLOWED",
    "TOO_MANY_REQUESTS",
    "UNKNOWN_PATH",
}

_INTRODUCTION = """\
Rejected and failed requests are answered with `application/problem+json` (RFC 9457): `type`,
`title`, `status`, `detail`, `instance`, and

| member | meaning |
|---|---|
| `code` | stable; see the table below |
| `hint` | how to fix it, if known |
| `blockers` | why a change is not possible now ([blockers](blockers.md)) |
| `available` | what can be requested instead |
| `errors` | `pointer`, `code` and `message` of each error in a body |
| `findings` | the errors in a model or waypoint file ([findings](findings.md)) |

A rejected request changes nothing. On the stream, the same document is sent as a frame of type
`problem`."""


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
