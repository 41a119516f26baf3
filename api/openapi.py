"""The description of the HTTP interface, corrected where the framework cannot know better."""

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from api.problems import MEDIA_TYPE, Problem
from api.schemas.inference import InferenceBody
from api.schemas.simulation import SimulationBody
from api.schemas.tasks import TaskBody

_REFERENCE = "#/components/schemas/{model}"
_PROBLEM = {"schema": {"$ref": _REFERENCE.format(model=Problem.__name__)}}


def describe(app: FastAPI) -> dict[str, Any]:
    """Return the OpenAPI document of `app`, made once.

    Every operation may answer with a problem, whatever its status; and bodies that routes read
    themselves are described here.
    """
    if app.openapi_schema is None:
        document = get_openapi(
            title=app.title,
            version=app.version,
            summary=app.summary,
            openapi_version=app.openapi_version,
            routes=app.routes,
        )
        schemas = document["components"]["schemas"]
        for kind in (Problem, InferenceBody, TaskBody, SimulationBody):
            schema = kind.model_json_schema(ref_template=_REFERENCE)
            schemas.update(schema.pop("$defs", {}))
            schemas[kind.__name__] = schema
        for path in document["paths"].values():
            for operation in path.values():
                _add_problems(operation["responses"])
        app.openapi_schema = document
    return app.openapi_schema


def _add_problems(responses: dict[str, Any]) -> None:
    """Say that each refusal is a problem; a change that did not succeed is one answer more."""
    responses["default"] = {"description": "A problem", "content": {MEDIA_TYPE: _PROBLEM}}
    for status, response in responses.items():
        if status.startswith(("4", "5")):
            response.setdefault("content", {})[MEDIA_TYPE] = _PROBLEM
