"""The description of the interface says what is the case, and shows it."""

from collections.abc import Iterator
from typing import Any

import pytest
from fastapi import FastAPI

from api.app import create_app
from api.documents.openapi import describe, operations_of
from api.http.problems import MEDIA_TYPE
from tests.support.document_schemas import leads_somewhere, openapi_faults, references
from tests.support.live_robot import make_supervisor


@pytest.fixture(scope="module")
def app() -> FastAPI:
    return create_app(make_supervisor(), allowed_hosts=[])


@pytest.fixture
def document(app: FastAPI) -> dict[str, Any]:
    return app.openapi()


def test_it_is_openapi_3_1_and_made_once(app: FastAPI, document: dict[str, Any]) -> None:
    assert document["openapi"].startswith("3.1")
    assert describe(app) is document


def test_it_says_what_it_is_and_on_which_terms(document: dict[str, Any]) -> None:
    info = document["info"]

    assert info["description"]
    assert info["license"]["identifier"] == "Apache-2.0"


def test_every_operation_says_in_a_line_and_in_full_what_it_does(document: dict[str, Any]) -> None:
    untold = [
        name
        for name, operation in operations_of(document)
        if not (operation["summary"] and operation["description"].startswith(operation["summary"]))
    ]

    assert untold == []


def test_a_summary_ends_with_the_first_clause(document: dict[str, Any]) -> None:
    canceling = document["paths"]["/changes/{change}"]["delete"]

    assert canceling["summary"] == "Cancel a change"
    assert canceling["description"].startswith("Cancel a change: no further step is started;")


def test_no_description_breaks_its_lines_where_the_source_does(document: dict[str, Any]) -> None:
    broken = [
        name
        for name, operation in operations_of(document)
        if "\n" in operation["description"].replace("\n\n", "")
    ]

    assert broken == []


def test_every_operation_is_in_a_group_that_is_described(document: dict[str, Any]) -> None:
    described = {tag["name"] for tag in document["tags"] if tag["description"]}
    used = {tag for _, operation in operations_of(document) for tag in operation["tags"]}

    assert used == described


def test_every_operation_may_answer_with_a_problem(document: dict[str, Any]) -> None:
    shared = document["components"]["responses"]["Problem"]
    defaults = [operation["responses"]["default"] for _, operation in operations_of(document)]

    assert {tuple(default.items()) for default in defaults} == {
        (("$ref", "#/components/responses/Problem"),)
    }
    assert list(shared["content"]) == [MEDIA_TYPE]


def test_every_parameter_is_described(document: dict[str, Any]) -> None:
    untold = [
        (name, parameter["name"])
        for name, operation in operations_of(document)
        for parameter in operation.get("parameters", ())
        if not parameter.get("description")
    ]

    assert untold == []


def test_every_parameter_of_a_path_has_an_example(document: dict[str, Any]) -> None:
    bare = [
        (name, parameter["name"])
        for name, operation in operations_of(document)
        for parameter in operation.get("parameters", ())
        if parameter["in"] == "path" and not parameter.get("example")
    ]

    assert bare == []


def test_every_body_and_every_answer_that_is_no_refusal_has_an_example(
    document: dict[str, Any],
) -> None:
    bare = [
        where
        for where, content in contents(document)
        if not where[1].startswith(("4", "5", "default")) and not content.get("examples")
    ]

    assert bare == []


def test_every_example_is_what_its_schema_says(document: dict[str, Any]) -> None:
    shared = document["components"]["responses"]["Problem"]["content"][MEDIA_TYPE]
    everything = [*contents(document), (("any", "refused", MEDIA_TYPE), shared)]
    wrong = [
        (where, key, faults)
        for where, content in everything
        for key, example in content.get("examples", {}).items()
        if (faults := openapi_faults(document, content["schema"], example["value"]))
    ]

    assert wrong == []


def test_a_refusal_is_shown_with_its_blockers_or_its_errors(document: dict[str, Any]) -> None:
    shared = document["components"]["responses"]["Problem"]["content"][MEDIA_TYPE]
    change = document["paths"]["/systems/{part}/mode"]["post"]["responses"]["409"]["content"]
    refused = [example["value"] for example in change[MEDIA_TYPE]["examples"].values()]

    assert [problem["blockers"][0]["code"] for problem in refused] == ["FINALIZED"]
    assert {
        problem["status"]: problem.get("errors")
        for problem in (example["value"] for example in shared["examples"].values())
    }.keys() == {404, 409, 422}


def test_no_answer_is_described_that_is_never_given(document: dict[str, Any]) -> None:
    assert "HTTPValidationError" not in document["components"]["schemas"]
    not_ready = document["paths"]["/readyz"]["get"]["responses"]["503"]

    assert list(not_ready["content"]) == [MEDIA_TYPE]


def test_a_token_may_be_needed_and_may_not(document: dict[str, Any]) -> None:
    assert document["security"] == [{}, {"bearer": []}]
    scheme = document["components"]["securitySchemes"]["bearer"]

    assert (scheme["type"], scheme["scheme"]) == ("http", "bearer")
    assert "PILOTHOUSE_TOKEN" in scheme["description"]


def test_every_reference_leads_somewhere(document: dict[str, Any]) -> None:
    lost = [name for name in references(document) if not leads_somewhere(document, name)]

    assert lost == []


def test_bodies_that_routes_read_themselves_are_described(document: dict[str, Any]) -> None:
    inference = document["paths"]["/inference"]["post"]["requestBody"]["content"]
    check = document["paths"]["/model/check"]["post"]["requestBody"]["content"]

    assert inference["application/json"]["schema"]["$ref"].endswith("/InferenceBody")
    assert "application/yaml" in check


@pytest.mark.parametrize(
    ("method", "path", "told"),
    [
        ("put", "/emergency_stop", "of the service does not release it"),
        ("post", "/signals", "or the mock if it is"),
        ("post", "/signals/{signal}", "or the mock if it is"),
    ],
)
def test_what_an_operator_could_be_surprised_by_is_told(
    method: str, path: str, told: str, document: dict[str, Any]
) -> None:
    assert told in document["paths"][path][method]["description"]


def contents(document: dict[str, Any]) -> Iterator[tuple[tuple[str, str, str], dict[str, Any]]]:
    """Yield what bodies and answers hold, with operation, `body` or status, and media type."""
    for name, operation in operations_of(document):
        body = operation.get("requestBody", {"content": {}})
        described = {"body": body, **operation["responses"]}
        for place, holder in described.items():
            for media_type, content in holder.get("content", {}).items():
                yield (name, place, media_type), content
