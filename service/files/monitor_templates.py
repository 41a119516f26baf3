"""Templates: signals and monitors that most robots need, which a robot file includes by name.

A template is a piece of a robot file with placeholders: `<name>` stands for a parameter, `<NAME>`
for the same in capitals. A key is left out if its value is a parameter that is empty.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any, Literal, TypeAlias, get_args

from domain.errors import InvalidValueError, near_match
from service.files.parameter_file import scalar_value
from service.files.yaml_tree import Mapping as MappingNode
from service.files.yaml_tree import Node, Scalar, Sequence, read_tree

TemplateName: TypeAlias = Literal[
    "battery",
    "camera",
    "clock",
    "cpu",
    "disk",
    "gps",
    "lidar",
    "memory",
    "motor",
    "network",
    "thermal",
    "topic",
]
TEMPLATES: tuple[str, ...] = get_args(TemplateName)
"""A name is never used as a path: only these files are opened."""
Parameter: TypeAlias = bool | int | float | str

_PLACEHOLDER = re.compile("<([A-Za-z_]+)>")
_ABOUT_ITSELF = ("requires", "defaults")


@dataclass(frozen=True, slots=True)
class MonitorTemplate:
    """A template with its parameters."""

    name: str
    requires: tuple[str, ...]
    """Parameters that have to be given."""
    defaults: Mapping[str, Parameter]
    """The other parameters, with their values if they are not given."""
    block: MappingNode
    """The piece of a robot file."""

    def filled(self, given: Mapping[str, Parameter]) -> dict[str, Any]:
        """Return the keys of a robot file, as plain values.

        Args:
            given: Parameters by name.

        Raises:
            InvalidValueError: A parameter is unknown or missing; `pointer` names it.
        """
        known = (*self.requires, *self.defaults)
        for parameter in given:
            if parameter not in known:
                near = near_match(parameter, known)
                hint = f"did you mean {near}?" if near else f"it has {', '.join(known)}"
                words = f"the template {self.name} has no parameter {parameter!r:.60}; {hint}"
                raise InvalidValueError(words, parameter)
        for parameter in self.requires:
            if parameter not in given:
                words = f"the template {self.name} requires {parameter}"
                raise InvalidValueError(words, parameter)
        filled: dict[str, Any] = _filled(self.block, {**self.defaults, **given})
        return {key: block for key, block in filled.items() if key not in _ABOUT_ITSELF}


def template_text(name: str) -> str:
    """Return one of `TEMPLATES` as YAML.

    Raises:
        InvalidValueError: There is no template of that name.
    """
    if name not in TEMPLATES:
        near = near_match(name, TEMPLATES)
        hint = f"did you mean {near}?" if near else f"there are {', '.join(TEMPLATES)}"
        raise InvalidValueError(f"there is no template {name!r:.60}; {hint}")
    return (resources.files("service") / "monitors" / f"{name}.yaml").read_text(encoding="utf-8")


@cache
def read_template(name: str) -> MonitorTemplate:
    """Return a template.

    Raises:
        InvalidValueError: There is no template of that name.
    """
    block = read_tree(template_text(name)).documents[0]
    assert isinstance(block, MappingNode)
    about = _filled(block, {})
    return MonitorTemplate(name, tuple(about.get("requires", ())), about.get("defaults", {}), block)


def _filled(node: Node | None, parameters: Mapping[str, Parameter]) -> Any:  # noqa: ANN401  # as in JSON
    """Return a tree as plain values, with its placeholders replaced where there is a value."""
    match node:
        case Scalar():
            whole = _PLACEHOLDER.fullmatch(node.text)
            if whole and whole[1] in parameters:
                return parameters[whole[1]]
            return _replaced(node.text, parameters) if "<" in node.text else scalar_value(node)
        case Sequence():
            return [_filled(item, parameters) for item in node.items]
        case MappingNode():
            return {
                _replaced(key.text, parameters): _filled(value, parameters)
                for key, value in node.entries
                if not _is_left_out(value, parameters)
            }
    return None


def _is_left_out(node: Node | None, parameters: Mapping[str, Parameter]) -> bool:
    whole = _PLACEHOLDER.fullmatch(node.text) if isinstance(node, Scalar) else None
    return whole is not None and parameters.get(whole[1]) == ""


def _replaced(text: str, parameters: Mapping[str, Parameter]) -> str:
    def value_of(found: re.Match[str]) -> str:
        name = found[1]
        if name in parameters:
            return str(parameters[name])
        if name.lower() in parameters:
            return str(parameters[name.lower()]).upper()
        return found[0]

    return _PLACEHOLDER.sub(value_of, text)
