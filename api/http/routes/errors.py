"""The errors of the robot and of its parts."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from api.http.dependencies import SupervisorDep
from api.http.error_answers import ActiveQuery, answer_errors
from api.http.route_policy import Permission, policy
from api.http.schemas.errors import ErrorsJson
from domain.computers import ComputerName
from domain.errors import UnknownPartError
from domain.state_and_mode import part_name

router = APIRouter(tags=["health"])


@router.get("/errors", response_model=ErrorsJson)
@policy(Permission.OBSERVE)
async def list_errors(
    supervisor: SupervisorDep,
    *,
    active: ActiveQuery = None,
    part: Annotated[
        str | None,
        Query(max_length=1_000, description="Only errors of this system, node or device"),
    ] = None,
    open_: Annotated[
        bool,
        Query(
            alias="open",
            description="true: only errors that are not normal, or that are shelved",
        ),
    ] = False,
) -> Response:
    """List the errors of the robot, of its devices and of all its parts, also the normal ones.

    They are in the order of their files; of `active=true` and `open=true`, in the order in which
    they came.
    """
    # What is due by now is an error by now.
    supervisor.let_pass()
    core = supervisor.core
    if part is None:
        views = core.open_errors().values() if active or open_ else core.errors()
        return await answer_errors(supervisor, views, active)
    name = part_name(part)
    if name not in supervisor.model and ComputerName(name) not in core.devices():
        raise UnknownPartError("part", name, supervisor.model.parts)
    of_part = (view for view in core.errors_of(name) if view.is_open or not open_)
    return await answer_errors(supervisor, of_part, active)
