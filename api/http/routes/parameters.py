"""Parameters of nodes, from which their modes are inferred."""

from typing import Annotated

from fastapi import APIRouter, Body, Request, Response

from api.http.body_parsing import InvalidBodyError
from api.http.change_answers import CHANGE_RESPONSES, ChangeOptionsDep, answer_change
from api.http.dependencies import ActorDep, PartDep, SupervisorDep
from api.http.request_body import JsonRoute
from api.http.route_policy import AuditClass, Permission, policy
from api.http.schemas.parts import ParameterRowJson, ParametersBody, ParametersJson
from domain.errors import UnknownParameterError
from domain.inputs import ParametersRequest
from domain.parameters import ParameterValue
from domain.state_and_mode import PartName
from service.supervisor import Supervisor

router = APIRouter(prefix="/nodes", tags=["nodes"], route_class=JsonRoute)


@router.get("/{part:path}/parameters")
@policy(Permission.OBSERVE)
async def list_parameters(part: PartDep, supervisor: SupervisorDep) -> ParametersJson:
    """List the parameters of a node, and the values that its target mode requires."""
    views = supervisor.core.parameters(part)
    return ParametersJson(items=[ParameterRowJson.of(view) for view in views])


@router.patch("/{part:path}/parameters", status_code=202, responses=CHANGE_RESPONSES)
@policy(Permission.OPERATE, AuditClass.UNLESS_DRY_RUN)
async def set_parameters(
    part: PartDep,
    body: Annotated[ParametersBody, Body()],
    options: ChangeOptionsDep,
    supervisor: SupervisorDep,
    actor: ActorDep,
    request: Request,
) -> Response:
    """Set parameters of a node, all or none; its inferred mode follows from them.

    An integer for a parameter that is known to be a double is converted, so that `1` may be written
    for `1.0`. A double is never converted to an integer.
    """
    values = _as_known(supervisor, part, body)
    try:
        asked = ParametersRequest(part, values, actor)
        return await answer_change(supervisor, asked, options, request)
    except UnknownParameterError as error:
        raise InvalidBodyError.at(error.name, error) from error


def _as_known(
    supervisor: Supervisor, node: PartName, sent: ParametersBody
) -> dict[str, ParameterValue]:
    """Turn integers into doubles where the node has doubles."""
    known = {view.name: view.value for view in supervisor.core.parameters(node)}
    return {name: _as_double(value, known.get(name)) for name, value in sent.items()}


def _as_double(sent: ParameterValue, known: ParameterValue | None) -> ParameterValue:
    if isinstance(known, float) and type(sent) is int:
        return float(sent)
    if isinstance(known, tuple) and isinstance(sent, tuple) and {*map(type, known)} == {float}:
        numbers = [item for item in sent if type(item) is int]
        return tuple(map(float, numbers)) if len(numbers) == len(sent) else sent
    return sent
