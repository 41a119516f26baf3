"""The description of the interface says what is the case."""

from typing import Any

import pytest
from fastapi import FastAPI

from api.app import create_app
from tests.support.live_robot import make_supervisor


@pytest.fixture(scope="module")
def app() -> FastAPI:
    return create_app(make_supervisor(), allowed_hosts=[])


@pytest.fixture
def document(app: FastAPI) -> dict[str, Any]:
    return app.openapi()


def operations(document: dict[str, Any]) -> list[dict[str, Any]]:
    return [operation for path in document["paths"].values() for operation in path.values()]


def test_it_is_openapi_3_1_and_made_once(app: FastAPI, document: dict[str, Any]) -> None:
    assert document["openapi"].startswith("3.1")
    assert app.openapi() is document


def test_every_operation_is_described_and_may_answer_with_a_problem(
    document: dict[str, Any],
) -> None:
    for operation in operations(document):
        assert operation["description"]
        assert "application/problem+json" in operation["responses"]["default"]["content"]


def test_no_answer_is_described_that_is_never_given(document: dict[str, Any]) -> None:
    assert "HTTPValidationError" not in document["components"]["schemas"]


def test_every_reference_leads_somewhere(document: dict[str, Any]) -> None:
    known = {f"#/components/schemas/{name}" for name in document["components"]["schemas"]}

    assert set(references(document)) <= known


def test_bodies_that_routes_read_themselves_are_described(document: dict[str, Any]) -> None:
    inference = document["paths"]["/inference"]["post"]["requestBody"]["content"]
    check = document["paths"]["/model/check"]["post"]["requestBody"]["content"]

    assert inference["application/json"]["schema"]["$ref"].endswith("/InferenceBody")
    assert "application/yaml" in check


@pytest.mark.parametrize(
    ("method", "path", "told"),
    [
        ("put", "/emergency_stop", "a restart of the service releases it"),
        ("post", "/signals", "or the mock where the mock runs"),
        ("post", "/signals/{signal}", "or the mock where the mock runs"),
    ],
)
def test_what_an_operator_could_be_surprised_by_is_told(
    method: str, path: str, told: str, document: dict[str, Any]
) -> None:
    description = document["paths"][path][method]["description"]

    assert told in " ".join(description.split())


def references(value: object) -> list[str]:
    if isinstance(value, dict):
        own = [value["$ref"]] if isinstance(value.get("$ref"), str) else []
        return own + [found for member in value.values() for found in references(member)]
    if isinstance(value, list):
        return [found for member in value for found in references(member)]
    return []
