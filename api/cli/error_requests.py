"""What operators ask of errors: to acknowledge and to shelve them, by their names among all."""

from typing import TYPE_CHECKING

from api.cli.error_lines import error_name
from api.cli.unknown_name import no_such
from api.client.outcomes import Json, ServiceProblemError

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient


def acknowledge(client: "ServiceClient", name: str) -> None:
    """Acknowledge an error.

    Args:
        client: The service.
        name: Such as `BATTERY_LOW` or `lidar.SILENT`.

    Raises:
        ServiceProblemError: There is no such error, or it was rejected.
        NoAnswerError: The service did not answer.
    """
    _ask(client, "POST", name, "acknowledge")


def shelve(client: "ServiceClient", name: str, for_s: float, reason: str) -> Json:
    """Do not announce an error for a time; return it as it is then.

    Args:
        client: The service.
        name: Such as `BATTERY_LOW` or `lidar.SILENT`.
        for_s: How long, in seconds.
        reason: Why.

    Raises:
        ServiceProblemError: There is no such error, or it was rejected.
        NoAnswerError: The service did not answer.
    """
    return _ask(client, "PUT", name, "shelf", {"for_s": for_s, "reason": reason})


def unshelve(client: "ServiceClient", name: str) -> None:
    """Announce an error again.

    Raises:
        ServiceProblemError: There is no such error, or it was rejected.
        NoAnswerError: The service did not answer.
    """
    _ask(client, "DELETE", name, "shelf")


def open_errors(client: "ServiceClient", part: str | None = None) -> Json:
    """Return the errors that an operator may want to see.

    Args:
        client: The service.
        part: Only of this system or node; None: all.

    Raises:
        ServiceProblemError: There is no such part.
        NoAnswerError: The service did not answer.
    """
    query = {"open": "true"} if part is None else {"open": "true", "part": part}
    return client.call("GET", "/errors", query=query)


def _ask(
    client: "ServiceClient", method: str, name: str, what: str, body: Json | None = None
) -> Json:
    part, _, error = name.rpartition(".")
    path = _path_of(client, part) if part else ""
    try:
        return client.call(method, f"{path}/errors/{error}/{what}", body)
    except ServiceProblemError as problem:
        if part or problem.problem.get("code") != "UNKNOWN_ERROR":
            raise
        # Perhaps one of a part was meant, and its part left out.
        items = client.call("GET", "/errors")["items"]
        alike = [error_name(item) for item in items if item["error"] == error]
        if alike:
            hint = f"did you mean {' or '.join(alike[:3])}?"
            detail = f"the robot itself has no error {name!r}"
            raise ServiceProblemError({"detail": detail, "hint": hint}) from problem
        raise no_such("error", name, [error_name(item) for item in items]) from problem


def _path_of(client: "ServiceClient", part: str) -> str:
    """Return the path of a part, or of a device, whose errors are named as those of parts are."""
    try:
        return client.path_of(part)
    except ServiceProblemError as problem:
        devices = client.call("GET", "/devices")["items"]
        if all(item["device"] != part for item in devices):
            raise problem from None
        return f"/devices/{part}"
