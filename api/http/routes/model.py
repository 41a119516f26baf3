"""The model of the robot, and checks of other models."""

from fastapi import APIRouter, Request, Response

from api.http.dependencies import SupervisorDep, WorkerDep
from api.http.model_jobs import check_posted
from api.http.request_body import limits_of, read_body
from api.http.route_policy import Permission, policy
from api.http.schemas.base import FindingJson
from api.http.schemas.inference import ModelCheckJson, ModelJson, NodeModelJson, SystemModelJson
from service.supervisor import Supervisor

router = APIRouter(prefix="/model", tags=["model"])

_YAML = "application/yaml"
_YAML_TYPES = (_YAML, "application/x-yaml", "text/yaml")


def encode_model(supervisor: Supervisor) -> bytes:
    """Return the loaded model as JSON; done at the start, since it is slow for 10,000 nodes."""
    model = supervisor.model
    settings = model.mode_settings
    shown = ModelJson(
        systems={
            name: SystemModelJson.of(system, settings.get(name, {}))
            for name, system in model.systems.items()
        },
        nodes={
            name: NodeModelJson.of(node, settings.get(name, {}))
            for name, node in model.nodes.items()
        },
        warnings=[FindingJson.of(finding) for finding in supervisor.warnings],
    )
    return shown.model_dump_json().encode()


@router.get(
    "",
    response_model=ModelJson,
    responses={200: {"content": {_YAML: {"schema": {"type": "string"}}}}},
)
@policy(Permission.OBSERVE)
async def get_model(request: Request, supervisor: SupervisorDep) -> Response:
    """Show the loaded model as JSON, or its file with `Accept: application/yaml`."""
    headers = {"Vary": "Accept"}
    accepted = request.headers.get("accept", "")
    if any(part.partition(";")[0].strip().lower() in _YAML_TYPES for part in accepted.split(",")):
        return Response(supervisor.model_text, headers=headers, media_type=_YAML)
    content: bytes = request.app.state.model_json
    return Response(content, headers=headers, media_type="application/json")


@router.post(
    "/check",
    response_model=ModelCheckJson,
    openapi_extra={"requestBody": {"content": {_YAML: {"schema": {}}}}},
)
@policy(Permission.OBSERVE)
async def check_posted_model(request: Request, worker: WorkerDep) -> Response:
    """Check a model (SMH, YAML): returns all errors and warnings at once."""
    raw = await read_body(request, limits_of(request).model_bytes)
    return Response(await worker.call(check_posted, raw), media_type="application/json")
