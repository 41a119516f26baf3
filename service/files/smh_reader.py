"""Reads systems and nodes from the parameters of each part of an SMH file.

Accepts what the C++ code of system_modes reads correctly, and reports what it would misread.

Source: micro-ROS system_modes, `mode_inference.cpp` (`read_modes_from_model`).
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from domain.findings import Finding
from domain.parameters import ParameterValue
from domain.parts.declared_errors import DeclaredError
from domain.parts.declared_reactions import DeclaredReaction
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import NodeModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode, part_name
from service.files.parameter_file import PARAMETERS_KEY, NodeParameters, Parameter
from service.files.smh_block import SmhBlock, WrittenCause, WrittenCondition
from service.files.smh_errors import read_errors
from service.files.smh_reactions import read_reactions
from service.files.smh_settings import read_mode_settings
from service.files.smh_values import fitted, read_part_name, read_rule, read_want
from service.files.source_text import SourceText

MAX_LINES = 2_000_000
"""Lines of all modes, including inherited ones; a model of 10,000 nodes has 100,000."""

_NAMES_IN_TEXT = re.compile(r"[/\w]+(?:[\s,]+[/\w]+)*")


@dataclass(slots=True)
class SmhParts:
    """All parts of an SMH file, and the findings about each."""

    nodes: dict[PartName, NodeModel] = field(default_factory=dict)
    systems: dict[PartName, SystemModel] = field(default_factory=dict)
    mode_settings: dict[PartName, Mapping[ModeName, ModeSettings]] = field(default_factory=dict)
    errors: dict[PartName, Mapping[str, DeclaredError]] = field(default_factory=dict)
    reactions: dict[PartName, Mapping[str, DeclaredReaction]] = field(default_factory=dict)
    conditions: list[WrittenCondition] = field(default_factory=list)
    causes: list[WrittenCause] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)


def read_parts(sources: Mapping[str, NodeParameters], source: SourceText) -> SmhParts:
    """Read all parts; one with errors is included as far as it can be read.

    Args:
        sources: Parameters by part.
        source: Text of the file.
    """
    blocks = [SmhBlock(source) for source in sources.values()]
    known = frozenset(block.name for block in blocks)
    with_modes = frozenset(block.name for block in blocks if block.modes)
    parts = SmhParts()
    lines = 0
    for block in blocks:
        own = len(block.modes) * len(block.modes.get(DEFAULT_MODE, ()))
        if lines + own > MAX_LINES:
            message = f"more than {MAX_LINES:,} lines in all modes, including {DEFAULT_MODE}"
            block.complain(block.key, "TOO_LARGE", message)
            block.modes.clear()
        else:
            lines += own
        if block.is_node:
            parts.nodes[block.name] = _read_node(block)
        else:
            parts.systems[block.name] = _read_system(block, with_modes)
        settings = read_mode_settings(block, known, source)
        if settings:
            parts.mode_settings[block.name] = settings
        errors = read_errors(block, source)
        if errors:
            parts.errors[block.name] = errors
        parts.causes.extend(block.causes)
        if reactions := read_reactions(block, with_modes, source):
            parts.reactions[block.name] = reactions
        parts.conditions.extend(block.conditions)
        parts.findings.extend(block.findings)
    return parts


def _read_node(block: SmhBlock) -> NodeModel:
    """Read a node: each mode overrides parameters of `__DEFAULT__`."""
    for rule in block.rules.values():
        message = f"{block.name} is a node; rules apply to systems only"
        block.warn(next(iter(rule.values())).key, "RULES_OF_A_NODE", message)
    own = {mode: _named_parameters(block, mode) for mode in block.modes}
    default = own.get(DEFAULT_MODE)
    modes: dict[ModeName, dict[str, ParameterValue]] = {}
    for mode, parameters in own.items():
        for name, parameter in parameters.items():
            if default is not None and name not in default:
                message = (
                    f"{block.name} in {mode}: parameter {name!r} is not in {DEFAULT_MODE}, which "
                    "must list all parameters"
                )
                block.complain(parameter.key, "PARAMETER_NOT_IN_DEFAULT", message)
        merged = {**(default or {}), **parameters}
        modes[mode] = {n: p.value for n, p in merged.items() if p.value is not None}
    return NodeModel(block.name, modes)


def _named_parameters(block: SmhBlock, mode: ModeName) -> dict[str, Parameter]:
    """Return the parameters below `ros__parameters` of a mode, by name."""
    named: dict[str, Parameter] = {}
    for below, parameter in block.modes[mode]:
        key, _, name = below.partition(".")
        if key == PARAMETERS_KEY and name:
            named[name] = parameter
        elif f".{PARAMETERS_KEY}." in below:
            _complain_of_dots(block, mode, below, parameter)
        else:
            message = (
                f"{block.name} in {mode}: {below!r} must be below {PARAMETERS_KEY}; the modes of a "
                "node hold parameters only"
            )
            block.complain(parameter.key, "MISSING_ROS_PARAMETERS", message)
    return named


def _read_system(block: SmhBlock, with_modes: Collection[PartName]) -> SystemModel:
    """Read a system: each mode overrides what `__DEFAULT__` requires of the parts."""
    if not block.modes:
        message = f"{block.name} is a system without modes and therefore without parts"
        block.warn(block.key, "NO_PARTS", message)
    named = {part_name(below) for below, _ in block.modes.get(DEFAULT_MODE, ())}
    if named:
        _compare_parts(block, named)
    own = {mode: _read_wants(block, mode, named, with_modes) for mode in block.modes}
    default = own.get(DEFAULT_MODE, {})
    modes = {mode: {**default, **wanted} for mode, wanted in own.items()}
    rules = [read_rule(block, name, with_modes) for name in block.rules]
    return SystemModel(block.name, modes, tuple(rule for rule in rules if rule is not None))


def _read_wants(
    block: SmhBlock,
    mode: ModeName,
    named: Collection[PartName],
    with_modes: Collection[PartName],
) -> dict[PartName, StateAndMode]:
    """Read the lines of one mode.

    Args:
        block: Block of the system.
        mode: The mode to read.
        named: Parts that `__DEFAULT__` names.
        with_modes: All parts that have modes.
    """
    where = f"{block.name} in {mode}"
    wanted: dict[PartName, StateAndMode] = {}
    for below, parameter in block.modes[mode]:
        if below.partition(".")[0] == PARAMETERS_KEY:
            message = f"{where}: only nodes have parameters; should {block.name} be a node?"
            block.complain(parameter.key, "PARAMETERS_OF_A_SYSTEM", message)
            continue
        if "." in below:
            _complain_of_dots(block, mode, below, parameter)
            continue
        part = read_part_name(block, where, below, parameter.key)
        if part in wanted:
            message = f"{where}: duplicate part {part}, with and without a leading slash"
            block.complain(parameter.key, "DUPLICATE_KEY", message)
            continue
        if named and part not in named:
            message = f"{where}: {part} is not in {DEFAULT_MODE} and so not a part of {block.name}"
            block.warn(parameter.key, "PART_NOT_IN_DEFAULT", message)
        if parameter.value is not None:
            want = read_want(block, f"{where}: {part}", parameter.value, parameter.place)
            if want is not None:
                wanted[part] = fitted(want, part, with_modes)
    return wanted


def _complain_of_dots(block: SmhBlock, mode: ModeName, below: str, parameter: Parameter) -> None:
    """Report a dot in a name: the C++ code truncates names at dots."""
    message = f"{block.name}: names of modes and parts must not contain dots: {mode}.{below}"
    block.complain(parameter.key, "DOTTED_NAME", message)


def _compare_parts(block: SmhBlock, named: set[PartName]) -> None:
    """Warn if `parts`, which is otherwise ignored, differs from the parts of `__DEFAULT__`."""
    for parameter in block.parts:
        names = parameter.value
        if isinstance(names, str) and _NAMES_IN_TEXT.fullmatch(names):
            names = tuple(re.split(r"[\s,]+", names))
        if parameter.name != "parts" or not isinstance(names, tuple):
            continue
        listed = {part_name(name) for name in names if isinstance(name, str)}
        if len(listed) != len(names):
            continue
        more, fewer = sorted(listed - named), sorted(named - listed)
        words = [f"it also lists {', '.join(more)}"] * bool(more)
        words += [f"it lacks {', '.join(fewer)}"] * bool(fewer)
        if words:
            message = (
                f"parts of {block.name} differs from {DEFAULT_MODE}, which is used: "
                f"{' and '.join(words)}"
            )
            block.warn(parameter.key, "PARTS_DIFFER", message)
