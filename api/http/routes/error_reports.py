"""Reports of errors that others find: a driver, a test, an operator."""

from functools import partial
from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Path, Response

from api.http.dependencies import ActorDep, PartDep, SupervisorDep
from api.http.error_text import error_text
from api.http.kept_requests import KeptDep, VolatileQuery
from api.http.request_body import JsonRoute
from api.http.route_policy import Permission, policy
from api.http.schemas.base import timestamp
from api.http.schemas.errors import ErrorJson, ErrorReportBody
from domain.inputs import ErrorReport
from domain.snapshot import ErrorKey

router = APIRouter(prefix="/errors", tags=["health"], route_class=JsonRoute)
part_router = APIRouter(route_class=JsonRoute)
"""For the errors of parts; below `/systems` and `/nodes`."""

ErrorPath = Annotated[str, Path(description="As in `GET /errors`")]


@router.post("/{error}", status_code=HTTPStatus.CONFLICT)
@policy(Permission.OPERATE)
async def report_error(
    error: ErrorPath,
    body: ErrorReportBody,
    kept: KeptDep,
    actor: ActorDep,
    *,
    volatile: VolatileQuery = False,
) -> None:
    """Report an error of the robot itself; it is rejected, since Pilothouse finds all of these."""
    report = ErrorReport(None, error, body.active, body.message, body.value, actor)
    await kept.submit(report, volatile=volatile)


@part_router.post("/{part:path}/errors/{error}", response_model=ErrorJson)
@policy(Permission.OPERATE)
async def report_part_error(
    part: PartDep,
    error: ErrorPath,
    body: ErrorReportBody,
    supervisor: SupervisorDep,
    kept: KeptDep,
    actor: ActorDep,
    *,
    volatile: VolatileQuery = False,
) -> Response:
    """Report an error of the part, or that it is over; over a restart it stays as it was reported.

    Only errors can be reported that the model file declares with neither `when` nor `caused_by`.
    Those of a part that is on a device are reported at that device; at the supervisor they are 409
    `ACTS_ELSEWHERE`.
    """
    report = ErrorReport(part, error, body.active, body.message, body.value, actor)
    await kept.submit(report, volatile=volatile)
    view = supervisor.core.error(ErrorKey(part, error))
    text = error_text(view, partial(timestamp, supervisor.clock))
    return Response(text, media_type="application/json")
