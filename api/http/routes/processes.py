"""The processes of nodes, where this computer runs them."""

from fastapi import APIRouter, Request, Response

from api.http.dependencies import ActorDep, PartDep, PartPath, SupervisorDep, known_part
from api.http.kept_requests import KeptDep, VolatileQuery
from api.http.longer_names import part_of_longer_name
from api.http.request_body import JsonRoute
from api.http.route_policy import Permission, policy
from api.http.schemas.processes import ProcessBody, ProcessJson
from domain.process_terms import ProcessRequest
from domain.state_and_mode import PartName
from service.ports import ProcessOutput
from service.supervisor import Supervisor

router = APIRouter(prefix="/nodes", tags=["nodes"], route_class=JsonRoute)

_NOTHING = ProcessOutput((), ())


@router.get("/{part:path}/process", response_model=ProcessJson)
@policy(Permission.OBSERVE)
async def get_process(part: PartPath, supervisor: SupervisorDep, request: Request) -> Response:
    """Show the process of a node: whether it runs, how it ended last, and what it printed.

    404 if the robot file has none of it on this computer.
    """
    if (whole := part_of_longer_name(f"{part}/process", request, supervisor)) is not None:
        return whole
    shown = _shown(known_part(part, request, supervisor), supervisor)
    return Response(shown.model_dump_json(), media_type="application/json")


@router.post("/{part:path}/process")
@policy(Permission.OPERATE)
async def change_process(
    part: PartDep,
    body: ProcessBody,
    supervisor: SupervisorDep,
    kept: KeptDep,
    actor: ActorDep,
    *,
    volatile: VolatileQuery = False,
) -> ProcessJson:
    """Start, stop or restart the process of a node; the answer shows what that began.

    A stop does not deactivate the node first, and its end is no error.
    """
    await kept.submit(ProcessRequest(part, body.action, actor), volatile=volatile)
    return _shown(part, supervisor)


def _shown(node: PartName, supervisor: Supervisor) -> ProcessJson:
    supervisor.let_pass()
    view, runner = supervisor.core.processes.view(node), supervisor.processes
    output = _NOTHING if runner is None else runner.output(node)
    return ProcessJson.of(view, output, supervisor.clock)
