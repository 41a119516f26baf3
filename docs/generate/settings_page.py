"""Settings: every key of a robot file, from its JSON Schema and the defaults of the core."""

from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

from docs.generate.markdown import code, joined, page, table
from docs.generate.robot_schema import robot_schema
from domain.health.signals import default_signals
from domain.simulation.node_settings import NodeSettings
from domain.timebase import to_seconds

Schema: TypeAlias = Mapping[str, Any]

_HEADS = ("key", "type", "unit", "default", "meaning")
# By the suffix of a key; the longest match applies.
_UNITS = {
    "_mps2": "m/s²",
    "_radps": "rad/s",
    "_mps": "m/s",
    "_rad": "rad",
    "_bytes": "bytes",
    "_hz": "Hz",
    "_m": "m",
    "_s": "s",
    "_per_s": "1/s",
}
_NAME_OF_ANY = {"nodes": "<node>", "signals": "<other>"}

_INTRODUCTION = """\
A robot file is YAML: `pilothouse serve MODEL --robot FILE`. All keys are optional. The `robot` of a
simulation has the same keys. Editors that support JSON Schema can complete them with
[robot-file.schema.json](robot-file.schema.json); [gem_e2.yaml](../../examples/robots/gem_e2.yaml)
is an example. Errors are reported with line and column ([findings](findings.md)).

A default in brackets applies if the key is left out or `null`."""


class _Document:
    """The schema, with references resolved."""

    def __init__(self, schema: Schema) -> None:
        self._definitions = schema.get("$defs", {})
        self.root = schema

    def resolved(self, schema: Schema) -> Schema:
        """Return a schema with what it refers to or wraps in `null`, its own words first."""
        kinds = [kind for kind in schema.get("anyOf", ()) if kind.get("type") != "null"]
        if len(kinds) == 1:
            schema = {**self.resolved(kinds[0]), **_without(schema, "anyOf")}
        if "$ref" in schema:
            named = self._definitions[schema["$ref"].rsplit("/", 1)[-1]]
            schema = {**self.resolved(named), **_without(schema, "$ref")}
        return schema

    def blocks(self, schema: Schema) -> Iterator[tuple[str, Schema]]:
        """Yield the keys of a block with their schemas; keys of any name come last, as empty."""
        for key, value in schema.get("properties", {}).items():
            yield key, self.resolved(value)
        if isinstance(schema.get("additionalProperties"), dict):
            yield "", self.resolved(schema["additionalProperties"])


def settings_page() -> str:
    """Return the page `settings.md`."""
    document = _Document(robot_schema())
    usual = dict(_usual())
    single, sections = [], []
    for key, schema in document.blocks(document.root):
        if _is_block(schema):
            rows = _rows(document, schema, key, "", usual)
            sections += [f"## {code(key)}", joined(schema["description"]), table(_HEADS, rows)]
        else:
            single.append(_row(key, schema, usual.get(key)))
    return page("Settings of a robot", _INTRODUCTION, table(_HEADS, single), *sections)


def _rows(
    document: _Document, block: Schema, section: str, prefix: str, usual: Mapping[str, str]
) -> Iterator[tuple[str, ...]]:
    """Yield a row for each key below a block, its inner blocks written with dots."""
    for key, schema in document.blocks(block):
        name = prefix + (key or _NAME_OF_ANY.get(section, "<name>"))
        if key == "source" and not prefix.startswith(_NAME_OF_ANY["signals"]):
            words = f"{joined(schema['description'])} As {code('<other>.source')}."
            yield code(name), "block", "", "", words
        elif _is_block(schema):
            yield code(name), "block", "", "", joined(schema.get("description", ""))
            yield from _rows(document, schema, section, f"{name}.", usual)
        else:
            yield _row(name, schema, usual.get(f"{section}.{name}"))


def _row(name: str, schema: Schema, usual: str | None) -> tuple[str, ...]:
    default = schema.get("default")
    shown = f"({usual})" if usual else "" if default is None else _value(default)
    return code(name), _type(schema), _unit(name), shown, joined(schema.get("description", ""))


def _is_block(schema: Schema) -> bool:
    return "properties" in schema or isinstance(schema.get("additionalProperties"), dict)


def _type(schema: Schema) -> str:
    if "enum" in schema:
        return ", ".join(map(code, schema["enum"]))
    if "const" in schema:
        return code(schema["const"])
    if "anyOf" in schema:
        return " or ".join(_type(kind) for kind in schema["anyOf"] if kind.get("type") != "null")
    kind = str(schema.get("type", "any")).replace("string", "text")
    limits = [
        f"{sign} {schema[key]:,.12g}"
        for key, sign in (
            ("minimum", "≥"),
            ("exclusiveMinimum", ">"),
            ("maximum", "≤"),
            ("exclusiveMaximum", "<"),
        )
        if key in schema
    ]
    return ", ".join((kind, *limits))


def _unit(name: str) -> str:
    ends = [end for end in _UNITS if name.endswith(end)]
    return _UNITS[max(ends, key=len)] if ends else ""


def _value(value: object) -> str:
    if value is None or value == "":
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) else code(str(value))


def _without(schema: Schema, key: str) -> Schema:
    return {name: value for name, value in schema.items() if name != key}


def _usual() -> Iterator[tuple[str, str]]:
    """Yield what is used where the schema says only `null`, by section and key."""
    for settings in default_signals():
        for setting, value in settings.facts().items():
            if value is not None:
                yield f"signals.{settings.spec.name}.{setting}", _value(value)
    yield "signals.stale_after_s", _value(to_seconds(default_signals()[0].stale_after))
    node = NodeSettings()
    for name in ("configure", "activate", "deactivate", "cleanup", "shutdown", "set_parameters"):
        yield f"nodes.<node>.{name}_s", _value(to_seconds(getattr(node, name)))
    for name in ("acceleration_mps2", "braking_mps2", "steering_rate_radps"):
        yield f"vehicle.plant.{name}", "no limit"
