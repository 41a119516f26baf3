"""Names of parts that end like the path of a resource of a part; the longest name wins."""

from functools import partial

from fastapi import Request, Response

from api.http.dependencies import known_of_kind
from api.http.part_text import part_text
from api.http.schemas.base import timestamp
from domain.state_and_mode import part_name
from service.supervisor import Supervisor


def part_of_longer_name(path: str, request: Request, supervisor: Supervisor) -> Response | None:
    """Return the part that a whole path names; None: there is none.

    Args:
        path: What follows the kind in the path of the request.
        request: Its path names the kind.
        supervisor: Knows all parts.
    """
    whole = part_name(path)
    if whole not in known_of_kind(request, supervisor):
        return None
    text = part_text(supervisor.core.part(whole), partial(timestamp, supervisor.clock))
    return Response(text, media_type="application/json")
