"""Schemas that viewers of MCAP understand."""

from collections.abc import Iterator
from typing import Any

import jsonschema_rs
import pytest
from pydantic import BaseModel

from api.http.schemas.health import EmergencyStopJson, StreamedSignalJson, SystemStateJson
from api.http.schemas.parts import PartJson
from api.http.schemas.tasks import HoldJson, TaskJson, VehicleJson
from api.recording.plain_schema import fitted, plain_schema

SHOWN = (
    SystemStateJson,
    PartJson,
    StreamedSignalJson,
    TaskJson,
    VehicleJson,
    HoldJson,
    EmergencyStopJson,
)


def faults_of(schema: dict[str, Any], path: str = "") -> Iterator[str]:
    """Yield what Lichtblick would reject."""
    kind = schema.get("type")
    if kind not in ("array", "boolean", "integer", "number", "object", "string"):
        yield f"{path}: type {kind}"
    if kind == "object" and not isinstance(schema.get("properties"), dict):
        yield f"{path}: no properties"
    for name, member in schema.get("properties", {}).items():
        yield from faults_of(member, f"{path}.{name}")
    if kind == "array":
        if schema["items"].get("type") == "array":
            yield f"{path}: an array of arrays"
        yield from faults_of(schema["items"], f"{path}[]")


@pytest.mark.parametrize("model", SHOWN)
def test_a_viewer_accepts_it(model: type[BaseModel]) -> None:
    schema = plain_schema(model)

    assert list(faults_of(schema, model.__name__)) == []
    jsonschema_rs.validator_for(schema)


class Below(BaseModel):
    number: float | None
    fact: bool | int | str | None


class Above(BaseModel):
    below: Below | None
    items: list[Below]
    facts: dict[str, float]


def test_what_is_null_is_left_out_and_what_may_be_anything_is_text() -> None:
    schema = plain_schema(Above)
    value = Above(
        below=None,
        items=[Below(number=1.5, fact=True), Below(number=None, fact="yes")],
        facts={"a": 1},
    )

    message = fitted(value.model_dump(mode="json"), schema)

    assert message == {
        "items": [{"number": 1.5, "fact": "true"}, {"fact": "yes"}],
        "facts": {"a": 1.0},
    }
    assert jsonschema_rs.is_valid(schema, message)
    assert schema["required"] == ["items", "facts"]


class Tree(BaseModel):
    name: str
    below: "list[Tree]"


def test_what_a_tree_has_below_its_top_is_text() -> None:
    schema = plain_schema(Tree)
    leaf = Tree(name="b", below=[Tree(name="a", below=[])])

    message = fitted(Tree(name="c", below=[leaf]).model_dump(), schema)

    assert list(faults_of(schema)) == []
    assert message == {
        "name": "c",
        "below": ['{"name": "b", "below": [{"name": "a", "below": []}]}'],
    }
    assert jsonschema_rs.is_valid(schema, message)
