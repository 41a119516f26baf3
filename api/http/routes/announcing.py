"""Acknowledging and shelving of errors, of the robot itself and of its parts.

Below `/errors` for the robot's own, below the path of a part or a device for theirs. Neither
silences anything but the announcing: states, bits and reactions stay as they are.
"""

from functools import partial
from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Path, Response

from api.http.dependencies import ActorDep, PartDep, SupervisorDep
from api.http.error_text import error_text
from api.http.kept_requests import KeptDep, VolatileDep
from api.http.request_body import JsonRoute
from api.http.route_policy import Permission, policy
from api.http.schemas.base import timestamp
from api.http.schemas.errors import ErrorJson, ShelfBody
from domain.inputs import AcknowledgeRequest, ShelveRequest, UnshelveRequest
from domain.snapshot import ErrorKey
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.supervisor import Supervisor

router = APIRouter(prefix="/errors", tags=["health"], route_class=JsonRoute)
part_router = APIRouter(route_class=JsonRoute)
"""For the errors of parts and devices; below `/systems`, `/nodes` and `/devices`."""

ErrorPath = Annotated[str, Path(description="As in `GET /errors`")]


@router.put("/{error}/shelf", response_model=ErrorJson)
@policy(Permission.OPERATE)
async def shelve_error(
    error: ErrorPath, body: ShelfBody, supervisor: SupervisorDep, kept: KeptDep, actor: ActorDep
) -> Response:
    """Do not announce an error of the robot itself for a time; repeating it begins the time anew.

    Its state, its bit and what follows from it stay as they are.
    """
    await kept.submit(ShelveRequest(error, seconds(body.for_s), body.reason, actor))
    return _answer(supervisor, None, error)


@router.delete("/{error}/shelf", status_code=HTTPStatus.NO_CONTENT, response_class=Response)
@policy(Permission.OPERATE)
async def unshelve_error(error: ErrorPath, kept: KeptDep, actor: ActorDep) -> None:
    """Announce an error of the robot itself again; one that is not shelved stays as it is."""
    await kept.submit(UnshelveRequest(error, actor))


@part_router.post("/{part:path}/errors/{error}/acknowledge", response_model=ErrorJson)
@policy(Permission.OPERATE)
async def acknowledge_part_error(
    part: PartDep,
    error: ErrorPath,
    supervisor: SupervisorDep,
    kept: KeptDep,
    actor: ActorDep,
    volatile: VolatileDep,
) -> Response:
    """Say that somebody has seen an error of the part.

    An error that has to be acknowledged ends once its cause is gone as well; while the cause is
    present, the acknowledgement counts when it goes, and is void when it comes again.
    """
    await kept.submit(AcknowledgeRequest(error, actor, part), volatile=volatile)
    return _answer(supervisor, part, error)


@part_router.put("/{part:path}/errors/{error}/shelf", response_model=ErrorJson)
@policy(Permission.OPERATE)
async def shelve_part_error(
    part: PartDep,
    error: ErrorPath,
    body: ShelfBody,
    supervisor: SupervisorDep,
    kept: KeptDep,
    actor: ActorDep,
) -> Response:
    """Do not announce an error of the part for a time; repeating it begins the time anew.

    Its state and what follows from it stay as they are.
    """
    await kept.submit(ShelveRequest(error, seconds(body.for_s), body.reason, actor, part))
    return _answer(supervisor, part, error)


@part_router.delete(
    "/{part:path}/errors/{error}/shelf",
    status_code=HTTPStatus.NO_CONTENT,
    response_class=Response,
)
@policy(Permission.OPERATE)
async def unshelve_part_error(
    part: PartDep, error: ErrorPath, kept: KeptDep, actor: ActorDep
) -> None:
    """Announce an error of the part again; one that is not shelved stays as it is."""
    await kept.submit(UnshelveRequest(error, actor, part))


def _answer(supervisor: Supervisor, part: PartName | None, error: str) -> Response:
    """Return an error as it is now."""
    view = supervisor.core.error(ErrorKey(part, error))
    text = error_text(view, partial(timestamp, supervisor.clock))
    return Response(text, media_type="application/json")
