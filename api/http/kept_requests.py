"""Requests whose outcome survives a restart; their answers say whether it is on disk yet."""

from typing import Annotated

from fastapi import Depends, Query, Request
from pydantic import Field

from api.http.schemas.base import Body
from domain.inputs import Input
from domain.outbox import Outputs
from service.supervisor import Supervisor

DURABLE_HEADER = "Pilothouse-Durable"
"""The header of an answer that tells whether its outcome would survive a restart."""
DURABLE = "pilothouse.durable"
"""Key in the scope of a request: a list that gets whether each outcome is on disk."""


class KeptRequests:
    """Submits what one HTTP request asks for."""

    def __init__(self, request: Request) -> None:
        self._supervisor: Supervisor = request.app.state.supervisor
        self._told: list[bool] = request.scope.get(DURABLE, [])

    async def submit(self, given: Input, *, volatile: bool = False) -> Outputs:
        """Submit to the core; return when the outcome is on disk, or that takes too long.

        Args:
            given: A request.
            volatile: Carry it out though storage fails; a restart may forget it.

        Raises:
            PilothouseError: The request is rejected, or cannot be stored first; nothing was done.
        """
        taken = await self._supervisor.request(given, volatile=volatile)
        if self._supervisor.journal is not None:
            self._told.append(taken.is_durable)
        return taken.outputs


# A coroutine, since the framework would call a plain function in a thread.
async def _kept_requests(request: Request) -> KeptRequests:
    return KeptRequests(request)


KeptDep = Annotated[KeptRequests, Depends(_kept_requests)]

_VOLATILE = "Do it though storage fails; a restart of the service may forget it"

VolatileQuery = Annotated[bool, Query(description=_VOLATILE)]


class VolatileBody(Body):
    """Whether something is done though storage fails, for a request that needs no body."""

    volatile: bool = Field(default=False, description=_VOLATILE)


async def _volatile(body: VolatileBody | None = None, *, volatile: VolatileQuery = False) -> bool:
    return volatile or (body is not None and body.volatile)


VolatileDep = Annotated[bool, Depends(_volatile)]
"""The same in the query or in a body, which may be left out; for routes of class `JsonRoute`."""
