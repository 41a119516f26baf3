"""Values in the modes and rules of systems: names of parts, states and modes.

Source: micro-ROS system_modes, `mode.cpp` (`StateAndMode::from_string`), `mode_inference.cpp`, and
`mode_handling.cpp` (`add_rule`).
"""

import difflib
from collections.abc import Collection

from domain.errors import shortened
from domain.lifecycle import LifecycleState
from domain.parameters import ParameterValue
from domain.parts.system_model import Rule
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from service.files.parameter_file import Parameter
from service.files.smh_block import SmhBlock
from service.files.yaml_tree import Node

_LABELS = [str(state) for state in LifecycleState]
_MAX_LABEL = 40
"""Characters compared with the known states: the comparison takes quadratic time."""
_RULE_KEYS = ("if_target", "if_part", "new_target")


def read_want(
    block: SmhBlock, where: str, text: ParameterValue, place: Node
) -> StateAndMode | None:
    """Read the state and mode that a mode requires of a part; None after reporting an error.

    Args:
        block: Receives findings.
        where: The place in words, for messages.
        text: Such as `active.FAST`.
        place: Place of the text in the file.
    """
    label, dot, mode = text.rpartition(".") if isinstance(text, str) else ("", "", "")
    want = _pair(block, where, label if dot else text, mode if dot else "", place)
    if want is not None and not want.state.is_primary:
        message = f"{where}: {want.state} is a transitional state; no part can stay in it"
        block.warn(place, "TRANSITIONAL_STATE", message)
    return want


def read_part_name(block: SmhBlock, where: str, text: str, place: Node) -> PartName:
    """Read the name of a part; the C++ code finds no part by a name with a leading slash.

    Args:
        block: Receives findings.
        where: The place in words, for messages.
        text: The name as written.
        place: Place of the name in the file.
    """
    name = text.removeprefix("/")
    if name != text:
        block.warn(place, "LEADING_SLASH", f"{where}: write {name} without a leading slash")
    return PartName(name)


def fitted(pair: StateAndMode, part: PartName, with_modes: Collection[PartName]) -> StateAndMode:
    """Add `__DEFAULT__` to `active` for a part with modes, or remove it for one without.

    Args:
        pair: State and mode as written.
        part: The part that they apply to.
        with_modes: All parts that have modes.
    """
    if pair.state is not LifecycleState.ACTIVE or pair.mode not in (None, DEFAULT_MODE):
        return pair
    return StateAndMode(pair.state, DEFAULT_MODE if part in with_modes else None)


def read_rule(block: SmhBlock, name: str, with_modes: Collection[PartName]) -> Rule | None:
    """Read a rule; None: too little of it can be read.

    Args:
        block: Block of the system; receives findings.
        name: Name of the rule.
        with_modes: All parts that have modes.
    """
    lines, where = block.rules[name], f"rule {name} of {block.name}"
    for key, line in lines.items():
        if key not in _RULE_KEYS:
            message = f"{where}: unknown key {key!r} in a rule; known: {', '.join(_RULE_KEYS)}"
            block.complain(line.key, "UNKNOWN_RULE_KEY", message)
    missing = [key for key in _RULE_KEYS if key not in lines]
    if missing:
        place = next(iter(lines.values())).key
        block.complain(place, "INCOMPLETE_RULE", f"{where} lacks {', '.join(missing)}")
    if_target, new_target = (
        _read_rule_target(block, f"{where}, {key}", lines.get(key), with_modes)
        for key in ("if_target", "new_target")
    )
    if_part = _read_if_part(block, f"{where}, if_part", lines.get("if_part"), with_modes)
    if if_target is None or if_part is None or new_target is None:
        return None
    return Rule(name, if_target, if_part, new_target)


def _read_rule_target(
    block: SmhBlock, where: str, line: Parameter | None, with_modes: Collection[PartName]
) -> StateAndMode | None:
    if line is None or line.value is None:
        return None
    pair = read_pair(block, where, line.value, line.place)
    return None if pair is None else fitted(pair, block.name, with_modes)


def _read_if_part(
    block: SmhBlock, where: str, line: Parameter | None, with_modes: Collection[PartName]
) -> tuple[PartName, StateAndMode] | None:
    if line is None or line.value is None:
        return None
    items = line.value if isinstance(line.value, tuple) else ()
    if len(items) < 2 or not isinstance(items[0], str):
        message = f"{where} must be a list of part and state, such as [drive_base, inactive]"
        block.complain(line.place, "INVALID_RULE", message)
        return None
    if len(items) > 2:
        block.warn(line.place, "INVALID_RULE", f"{where}: items after the first two are ignored")
    part = read_part_name(block, where, items[0], line.place)
    pair = read_pair(block, where, items[1], line.place)
    return None if pair is None else (part, fitted(pair, part, with_modes))


def read_pair(
    block: SmhBlock, where: str, text: ParameterValue, place: Node
) -> StateAndMode | None:
    """Read a state and mode as written in rules and reactions; None after reporting an error.

    Args:
        block: Receives findings.
        where: The place in words, for messages.
        text: Such as `active.FAST`.
        place: Place of the text in the file.
    """
    label, _, mode = text.partition(".") if isinstance(text, str) else (text, "", "")
    return _pair(block, where, label, mode, place)


def _pair(
    block: SmhBlock, where: str, label: ParameterValue, mode: str, place: Node
) -> StateAndMode | None:
    """Combine state and mode; only active has a mode."""
    if label not in _LABELS:
        near = difflib.get_close_matches(str(label)[:_MAX_LABEL].lower(), _LABELS, n=1)
        hint = f"did you mean {near[0]}?" if near else "known: active, inactive, unconfigured, ..."
        shown = shortened(label) if isinstance(label, str) else label
        message = f"{where}: unknown state {shown!r}; {hint}"
        block.complain(place, "UNKNOWN_STATE", message)
        return None
    state = LifecycleState(str(label))
    if mode and state is not LifecycleState.ACTIVE:
        block.warn(
            place, "INERT_MODE", f"{where}: mode {mode} has no effect; only active has modes"
        )
        return StateAndMode(state)
    return StateAndMode(state, ModeName(mode) if mode else None)
