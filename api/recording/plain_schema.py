"""JSON Schema in the subset that viewers of MCAP understand, and messages that fit it.

Lichtblick reads `type`, `properties` and `items`, and rejects a channel with anything else: no
references, no alternatives, no null, no object without `properties`. So references are resolved,
what is null is left out of a message, and a value that may be of several types is told as text. So
is what a tree has below its top, such as the causes of a reason.
"""

import json
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

from pydantic import BaseModel

Schema: TypeAlias = dict[str, Any]

_KEPT = ("type", "description", "enum", "const", "format", "minimum", "maximum")


def plain_schema(model: type[BaseModel]) -> Schema:
    """Return the schema of a message; members that may be null are not required."""
    whole = model.model_json_schema(mode="serialization")
    return _plain(whole, whole.get("$defs", {}), frozenset())


def fitted(value: Any, schema: Schema) -> Any:  # noqa: ANN401  # JSON
    """Return a value as its schema says: without null, and as text where it has several types."""
    if schema.get("type") == "string" and not isinstance(value, str):
        return json.dumps(value)
    match value:
        case Mapping():
            known = schema.get("properties", {})
            return {
                name: fitted(member, known.get(name, {}))
                for name, member in value.items()
                if member is not None
            }
        case str():
            return value
        case Sequence():
            return [fitted(item, schema.get("items", {})) for item in value if item is not None]
        case _:
            return value


def _plain(
    schema: Mapping[str, Any], definitions: Mapping[str, Any], inside: frozenset[str]
) -> Schema:
    """Return a schema without references.

    Args:
        schema: With references.
        definitions: What they name.
        inside: The definitions that it stands inside of.
    """
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        if name in inside:
            return {"type": "string", **_described(schema)}
        named = _plain(definitions[name], definitions, inside | {name})
        return {**named, **_described(schema)}
    choices = [one for one in schema.get("anyOf", ()) if one.get("type") != "null"]
    if choices:
        single = len(choices) == 1
        chosen = _plain(choices[0], definitions, inside) if single else {"type": "string"}
        return {**chosen, **_described(schema)}
    kept = {name: schema[name] for name in _KEPT if name in schema}
    kind = schema.get("type", "string")
    if kind == "object":
        members = schema.get("properties", {})
        kept["properties"] = {
            name: _plain(one, definitions, inside) for name, one in members.items()
        }
        optional = {name for name, one in members.items() if _may_be_null(one)}
        kept["required"] = [name for name in schema.get("required", ()) if name not in optional]
    elif kind == "array":
        kept["items"] = _plain(schema.get("items", {"type": "string"}), definitions, inside)
    return {"type": kind, **kept}


def _described(schema: Mapping[str, Any]) -> Schema:
    return {name: schema[name] for name in ("description",) if name in schema}


def _may_be_null(schema: Mapping[str, Any]) -> bool:
    return any(one.get("type") == "null" for one in schema.get("anyOf", ()))
