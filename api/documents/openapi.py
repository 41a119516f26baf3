"""The OpenAPI document: what the framework makes of the routes, and what it cannot know."""

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from api.documents.examples import Exchange, key_of, load_examples
from api.documents.wording import DESCRIPTION, LICENSE, TAGS, TOKEN
from api.http.problems import MEDIA_TYPE
from api.http.route_table import unfolded
from api.http.schemas.inference import InferenceBody
from api.http.schemas.problem import Problem
from api.http.schemas.simulation import SimulationBody
from api.http.schemas.tasks import TaskBody

_REFERENCE = "#/components/schemas/{model}"
_PROBLEM = {"$ref": _REFERENCE.format(model=Problem.__name__)}
_ANY_PROBLEM = {"$ref": "#/components/responses/Problem"}

_NEVER_GIVEN = "422"
"""How the framework would answer what is invalid; here that is a problem."""
_OF_NEVER_GIVEN = ("HTTPValidationError", "ValidationError")

_READ_BY_ROUTES = (InferenceBody, TaskBody, SimulationBody)
"""Bodies that routes read themselves, so that the framework does not know them."""


def describe(app: FastAPI) -> dict[str, Any]:
    """Return the OpenAPI document of `app`, made once.

    Every operation may answer with a problem, whatever its status; every other answer and every
    body has an example.
    """
    if app.openapi_schema is None:
        document = get_openapi(
            title=app.title,
            version=app.version,
            summary=app.summary,
            description=DESCRIPTION,
            license_info=dict(LICENSE),
            openapi_version=app.openapi_version,
            routes=unfolded(app.routes),
            tags=[{"name": name, "description": told} for name, told in TAGS.items()],
        )
        _add_components(document["components"])
        # Without a token nothing is asked of a client; with one it is the same for all operations.
        document["security"] = [{}, {"bearer": []}]
        exchanges = _by_operation(load_examples().requests)
        for name, operation in operations_of(document):
            _describe_operation(operation)
            _add_examples(operation, exchanges[name], document["components"]["responses"])
        app.openapi_schema = document
    return app.openapi_schema


def operations_of(document: Mapping[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield each operation of a document with its name: `GET /systems`."""
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            yield f"{method.upper()} {path}", operation


def _add_components(components: dict[str, Any]) -> None:
    schemas = components["schemas"]
    for name in _OF_NEVER_GIVEN:
        schemas.pop(name, None)
    for kind in (Problem, *_READ_BY_ROUTES):
        schema = kind.model_json_schema(ref_template=_REFERENCE)
        schemas.update(schema.pop("$defs", {}))
        schemas[kind.__name__] = schema
    components["responses"] = {
        "Problem": {
            "description": "Refused, or failed; nothing was changed unless the code says so",
            "content": {MEDIA_TYPE: {"schema": _PROBLEM}},
        }
    }
    components["securitySchemes"] = {
        "bearer": {"type": "http", "scheme": "bearer", "description": TOKEN}
    }


def _describe_operation(operation: dict[str, Any]) -> None:
    """Take the summary from the description, and say that each refusal is a problem."""
    paragraphs = operation["description"].split("\n\n")
    # Lines of a docstring end where the source does; a page would break them there too.
    paragraphs = [" ".join(paragraph.split()) for paragraph in paragraphs]
    operation["description"] = "\n\n".join(paragraphs)
    operation["summary"] = _first_clause(paragraphs[0])
    responses = operation["responses"]
    responses.pop(_NEVER_GIVEN, None)
    responses["default"] = _ANY_PROBLEM
    for status, response in responses.items():
        if status.startswith(("4", "5")):
            response.setdefault("content", {})[MEDIA_TYPE] = {"schema": _PROBLEM}


def _first_clause(line: str) -> str:
    """Return what is said before the first `.`, `:` or `;` that ends a clause."""
    return re.split(r"[.:;](?: |$)", line, maxsplit=1)[0]


def _by_operation(exchanges: Sequence[Exchange]) -> Mapping[str, list[Exchange]]:
    found = defaultdict[str, list[Exchange]](list)
    for exchange in exchanges:
        found[exchange.operation].append(exchange)
    return found


def _add_examples(
    operation: dict[str, Any], exchanges: Sequence[Exchange], shared: Mapping[str, Any]
) -> None:
    """Show what was asked of an operation and what came of it.

    Args:
        operation: Of the document.
        exchanges: With this operation.
        shared: Responses that several operations refer to.
    """
    if exchanges:
        for parameter in operation.get("parameters", ()):
            if parameter["in"] == "path":
                parameter["example"] = exchanges[0].path[parameter["name"]]
    for exchange in exchanges:
        # What is refused as things are is asked rightly all the same.
        is_right = exchange.answer_type != MEDIA_TYPE or exchange.status == HTTPStatus.CONFLICT
        if exchange.body_type is not None and is_right:
            content = operation["requestBody"]["content"][exchange.body_type]
            _add_example(content, exchange.summary, exchange.body)
        if exchange.answer_type is not None:
            response = operation["responses"].get(str(exchange.status), shared["Problem"])
            content = response["content"][exchange.answer_type]
            _add_example(content, exchange.summary, exchange.answer)


def _add_example(content: dict[str, Any], summary: str, value: object) -> None:
    examples: dict[str, Any] = content.setdefault("examples", {})
    examples[key_of(summary)] = {"summary": summary, "value": value}
