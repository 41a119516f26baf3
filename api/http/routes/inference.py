"""Inference of states and modes from posted facts."""

from fastapi import APIRouter, Request, Response

from api.http.body_parsing import parse_body
from api.http.dependencies import SupervisorDep, WorkerDep
from api.http.model_jobs import infer, infer_posted
from api.http.request_body import limits_of, read_body
from api.http.route_policy import Permission, policy
from api.http.schemas.inference import InferenceBody, InferenceJson

router = APIRouter(tags=["inference"])

_MAX_BYTES_HERE = 16_384
_MAX_PARTS_HERE = 100
"""Up to these limits the job takes less than 5 ms, and is not worth sending to the worker."""


@router.post(
    "/inference",
    response_model=InferenceJson,
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {
                "application/json": {"schema": {"$ref": "#/components/schemas/InferenceBody"}}
            },
        }
    },
)
@policy(Permission.OBSERVE)
async def infer_from_facts(
    request: Request, supervisor: SupervisorDep, worker: WorkerDep
) -> Response:
    """Infer states and modes from targets and reported facts; nothing live is read or changed.

    The default `model` is the loaded one. A node that is left out, or has no `state`, counts as
    never reported. `mode` is a reported mode; without it, the mode is inferred from the parameters.
    """
    raw = await read_body(request, limits_of(request).model_bytes)
    if len(raw) <= _MAX_BYTES_HERE and len(supervisor.model.parts) <= _MAX_PARTS_HERE:
        body = parse_body(InferenceBody, raw)
        if body.model is None:
            content = infer(supervisor.model, body).model_dump_json().encode()
            return Response(content, media_type="application/json")
    content = await worker.call(infer_posted, raw, supervisor.model_text)
    return Response(content, media_type="application/json")
