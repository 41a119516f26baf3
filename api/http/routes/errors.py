"""The errors of the robot and of its parts."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from api.http.dependencies import SupervisorDep
from api.http.error_answers import ActiveQuery, answer_errors
from api.http.route_policy import Permission, policy
from api.http.schemas.errors import ErrorsJson
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
        str | None, Query(max_length=1_000, description="Only errors of this system or node")
    ] = None,
) -> Response:
    """List the errors of the robot and of all its parts, also those that are normal.

    They are in the order of the model file; of `active=true`, in the order in which they came.
    """
    # What is due by now is an error by now.
    supervisor.let_pass()
    core = supervisor.core
    if part is None:
        open_ones = core.open_errors().values()
        return await answer_errors(supervisor, open_ones if active else core.errors(), active)
    name = part_name(part)
    if name not in supervisor.model:
        raise UnknownPartError("part", name, supervisor.model.parts)
    return await answer_errors(supervisor, core.errors_of(name), active)
