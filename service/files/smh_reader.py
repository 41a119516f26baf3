"""Systems and nodes from the parameters that an SMH file gives each part.

Takes what the C++ of system_modes takes, and complains of what that takes and misreads.

Source: micro-ROS system_modes, `mode_inference.cpp` (`read_modes_from_model`).
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from domain.findings import Finding
from domain.parameters import ParameterValue
from domain.parts.system_model import NodeModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode, part_name
from service.files.parameter_file import PARAMETERS_KEY, NodeParameters, Parameter
from service.files.smh_block import SmhBlock
from service.files.smh_values import fitted, read_part_name, read_rule, read_want

MAX_LINES = 2_000_000
"""Of all modes, each with what it takes over; a model of 10,000 nodes has 100,000."""

_NAMES_IN_TEXT = re.compile(r"[/\w]+(?:[\s,]+[/\w]+)*")


@dataclass(slots=True)
class SmhParts:
    """All parts of an SMH file, and what is wrong with each by itself."""

    nodes: dict[PartName, NodeModel] = field(default_factory=dict)
    systems: dict[PartName, SystemModel] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)


def read_parts(sources: Mapping[str, NodeParameters]) -> SmhParts:
    """Read all parts; one with faults is there as far as it can be read."""
    blocks = [SmhBlock(source) for source in sources.values()]
    with_modes = frozenset(block.name for block in blocks if block.modes)
    parts = SmhParts()
    lines = 0
    for block in blocks:
        own = len(block.modes) * len(block.modes.get(DEFAULT_MODE, ()))
        if lines + own > MAX_LINES:
            message = f"more than {MAX_LINES:,} lines in all modes, with those of {DEFAULT_MODE}"
            block.complain(block.key, "TOO_LARGE", message)
            block.modes.clear()
        else:
            lines += own
        if block.is_node:
            parts.nodes[block.name] = _read_node(block)
        else:
            parts.systems[block.name] = _read_system(block, with_modes)
        parts.findings.extend(block.findings)
    return parts


def _read_node(block: SmhBlock) -> NodeModel:
    """Read a node: each mode is a set of parameters over that of `__DEFAULT__`."""
    for rule in block.rules.values():
        message = f"{block.name} is a node; rules have an effect in systems only"
        block.warn(next(iter(rule.values())).key, "RULES_OF_A_NODE", message)
    own = {mode: _named_parameters(block, mode) for mode in block.modes}
    default = own.get(DEFAULT_MODE)
    modes: dict[ModeName, dict[str, ParameterValue]] = {}
    for mode, parameters in own.items():
        for name, parameter in parameters.items():
            if default is not None and name not in default:
                message = (
                    f"{block.name} in {mode}: there is no parameter {name!r} in {DEFAULT_MODE}, "
                    "which must name them all"
                )
                block.complain(parameter.key, "PARAMETER_NOT_IN_DEFAULT", message)
        merged = {**(default or {}), **parameters}
        modes[mode] = {n: p.value for n, p in merged.items() if p.value is not None}
    return NodeModel(block.name, modes)


def _named_parameters(block: SmhBlock, mode: ModeName) -> dict[str, Parameter]:
    """Return what stands below `ros__parameters` of a mode, by name."""
    named: dict[str, Parameter] = {}
    for below, parameter in block.modes[mode]:
        key, _, name = below.partition(".")
        if key == PARAMETERS_KEY and name:
            named[name] = parameter
        elif f".{PARAMETERS_KEY}." in below:
            _complain_of_dots(block, mode, below, parameter)
        else:
            message = (
                f"{block.name} in {mode}: {below!r} is not below {PARAMETERS_KEY}; the modes of a "
                "node hold parameters"
            )
            block.complain(parameter.key, "MISSING_ROS_PARAMETERS", message)
    return named


def _read_system(block: SmhBlock, with_modes: Collection[PartName]) -> SystemModel:
    """Read a system: each mode says what is wanted of parts, over what `__DEFAULT__` says."""
    if not block.modes:
        message = f"{block.name} is a system without modes, and so without parts"
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
    """Read the lines of one mode; `named` are the parts that `__DEFAULT__` names."""
    where = f"{block.name} in {mode}"
    wanted: dict[PartName, StateAndMode] = {}
    for below, parameter in block.modes[mode]:
        if below.partition(".")[0] == PARAMETERS_KEY:
            message = f"{where}: only a node has parameters; is {block.name} of type node?"
            block.complain(parameter.key, "PARAMETERS_OF_A_SYSTEM", message)
            continue
        if "." in below:
            _complain_of_dots(block, mode, below, parameter)
            continue
        part = read_part_name(block, where, below, parameter.key)
        if part in wanted:
            message = f"{where}: {part} is there twice, with a slash before it and without"
            block.complain(parameter.key, "DUPLICATE_KEY", message)
            continue
        if named and part not in named:
            message = f"{where}: {part} is not in {DEFAULT_MODE}, and so no part of {block.name}"
            block.warn(parameter.key, "PART_NOT_IN_DEFAULT", message)
        if parameter.value is not None:
            want = read_want(block, f"{where}: {part}", parameter.value, parameter.place)
            if want is not None:
                wanted[part] = fitted(want, part, with_modes)
    return wanted


def _complain_of_dots(block: SmhBlock, mode: ModeName, below: str, parameter: Parameter) -> None:
    """Names are told apart by dots, so that C++ cuts off a name at a dot in it."""
    message = f"{block.name}: neither a mode nor a part can have a dot in its name: {mode}.{below}"
    block.complain(parameter.key, "DOTTED_NAME", message)


def _compare_parts(block: SmhBlock, named: set[PartName]) -> None:
    """Warn if `parts`, which nothing else reads, tells of other parts than `__DEFAULT__`."""
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
                f"parts of {block.name} differs from {DEFAULT_MODE}, which counts: "
                f"{' and '.join(words)}"
            )
            block.warn(parameter.key, "PARTS_DIFFER", message)
