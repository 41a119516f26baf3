"""Check values against the schemas of the documents, by their own references."""

from collections.abc import Iterator, Mapping
from typing import Any

from jsonschema_rs import Draft7Validator, Draft202012Validator


def openapi_faults(document: Mapping[str, Any], schema: object, value: object) -> list[str]:
    """Return what is wrong with a value; OpenAPI 3.1 has JSON Schema as of 2020-12."""
    whole = {"components": document["components"], "allOf": [schema]}
    checked = Draft202012Validator(whole, validate_formats=True)
    return [str(error) for error in checked.iter_errors(value)]


def asyncapi_faults(document: Mapping[str, Any], message: Mapping[str, Any]) -> list[str]:
    """Return what is wrong with a message of the stream; AsyncAPI has JSON Schema as of draft 7."""
    described = document["components"]["messages"][message["type"]]
    whole = {"components": document["components"], "allOf": [described["payload"]]}
    checked = Draft7Validator(whole, validate_formats=True)
    return [str(error) for error in checked.iter_errors(message)]


def references(value: object) -> Iterator[str]:
    """Yield every reference in a document."""
    if isinstance(value, dict):
        if isinstance(value.get("$ref"), str):
            yield value["$ref"]
        for member in value.values():
            yield from references(member)
    if isinstance(value, list):
        for item in value:
            yield from references(item)


def leads_somewhere(document: Mapping[str, Any], reference: str) -> bool:
    """Tell whether there is what a reference inside a document names."""
    found: Any = document
    for key in reference.removeprefix("#/").split("/"):
        key = key.replace("~1", "/").replace("~0", "~")
        if key not in found:
            return False
        found = found[key]
    return reference.startswith("#/")
