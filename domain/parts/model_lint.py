"""Warnings about valid models: constructs that the author probably did not intend.

Source: reports of users of micro-ROS system_modes (issues #43, #94).
"""

from collections import defaultdict
from collections.abc import Hashable, Iterator, Mapping

from domain.findings import Finding
from domain.lifecycle import LifecycleState
from domain.parameters import ParameterValue, value_type
from domain.parts.system_model import NodeModel, Rule, SmhModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode


def lint(model: SmhModel) -> list[Finding]:
    """Return warnings; the effort is linear in the size of the model."""
    findings: list[Finding] = []
    for node in model.nodes.values():
        findings.extend(_modes_alike(node.name, _node_looks(node)))
        findings.extend(_types_that_differ(node))
        findings.extend(_never_inferred(node))
    for system in model.systems.values():
        findings.extend(_modes_alike(system.name, _system_looks(system)))
        findings.extend(_rules_that_undo_a_request(system))
        findings.extend(_rules_in_a_circle(system))
    findings.extend(_conflicts(model))
    return findings


def _warning(code: str, message: str, *path: str) -> Finding:
    return Finding("warning", code, message, path[0], path)


# --- modes that look alike -----------------------------------------------------------------------


def _node_looks(node: NodeModel) -> Iterator[tuple[ModeName, Hashable]]:
    """Yield each mode with its identity: types and values of its parameters."""
    for mode, parameters in node.modes.items():
        yield mode, frozenset((n, value_type(v), v) for n, v in parameters.items())


def _system_looks(system: SystemModel) -> Iterator[tuple[ModeName, Hashable]]:
    for mode, wanted in system.modes.items():
        yield mode, frozenset((part, _meaning(want)) for part, want in wanted.items())


def _meaning(pair: StateAndMode) -> StateAndMode:
    """Return one value for pairs that agree: only active has modes, and None is the default."""
    if pair.state is not LifecycleState.ACTIVE:
        return StateAndMode(pair.state)
    return StateAndMode(pair.state, pair.mode or DEFAULT_MODE)


def _modes_alike(part: PartName, looks: Iterator[tuple[ModeName, Hashable]]) -> Iterator[Finding]:
    first: dict[Hashable, ModeName] = {}
    for mode, look in looks:
        other = first.setdefault(look, mode)
        if other != mode:
            message = f"{part}: {mode} is the same as {other}; inference cannot tell the two apart"
            yield _warning("MODES_ALIKE", message, part, "modes", mode)


# --- parameters ----------------------------------------------------------------------------------


def _types_that_differ(node: NodeModel) -> Iterator[Finding]:
    default = node.modes.get(DEFAULT_MODE, {})
    for mode, parameters in node.modes.items():
        for name, value in parameters.items():
            usual, own = value_type(default.get(name, value)), value_type(value)
            if usual != own:
                message = (
                    f"{node.name} in {mode}: {name} is {own} here and {usual} in {DEFAULT_MODE}; "
                    "a node accepts only one of these types"
                )
                yield _warning("TYPE_DIFFERS", message, node.name, "modes", mode, name)


def _never_inferred(node: NodeModel) -> Iterator[Finding]:
    """Find values that never compare equal; values inherited from the default are told once."""
    default = node.modes.get(DEFAULT_MODE, {})
    for mode, parameters in node.modes.items():
        for name, value in parameters.items():
            taken_over = mode != DEFAULT_MODE and default.get(name) is value
            if not taken_over and _is_never_equal(value):
                message = (
                    f"{node.name} in {mode}: {name} holds NaN, which never equals anything; "
                    "the mode is never inferred from its parameters"
                )
                yield _warning("NEVER_INFERRED", message, node.name, "modes", mode, name)


def _is_never_equal(value: ParameterValue) -> bool:
    items = value if isinstance(value, tuple) else (value,)
    return any(item != item for item in items)


# --- rules ---------------------------------------------------------------------------------------


def _rules_that_undo_a_request(system: SystemModel) -> Iterator[Finding]:
    for rule in system.rules:
        part, condition = rule.if_part
        wanted = _wanted(system, rule.if_target)
        if part in wanted and wanted[part].agrees_with(condition):
            message = (
                f"rule {rule.name} of {system.name} gives up {rule.if_target.label} when {part} is "
                f"{condition.label}, which {rule.if_target.label} itself requires"
            )
            yield _warning("RULE_UNDOES_REQUEST", message, system.name, "rules", rule.name)


def _wanted(system: SystemModel, target: StateAndMode) -> Mapping[PartName, StateAndMode]:
    if target.state is LifecycleState.ACTIVE:
        return system.modes.get(target.mode or DEFAULT_MODE, {})
    return {part: StateAndMode(target.state) for part in system.parts}


def _rules_in_a_circle(system: SystemModel) -> Iterator[Finding]:
    """Find cycles of targets; each is reported at the rule that closes it."""
    rules: dict[StateAndMode, list[Rule]] = defaultdict(list)
    for rule in system.rules:
        rules[_meaning(rule.if_target)].append(rule)
    done: set[StateAndMode] = set()
    for start in list(rules):
        if start in done:
            continue
        trail: dict[StateAndMode, None] = {start: None}
        waiting = [iter(rules[start])]
        while waiting:
            next_rule = next(waiting[-1], None)
            if next_rule is None:
                waiting.pop()
                done.add(trail.popitem()[0])
                continue
            goal = _meaning(next_rule.new_target)
            if goal in trail:
                labels = [target.label for target in trail]
                circle = " > ".join([*labels[labels.index(goal.label) :], goal.label])
                message = f"rules of {system.name} form a cycle: {circle}"
                yield _warning("RULE_CIRCLE", message, system.name, "rules", next_rule.name)
            elif goal not in done and goal in rules:
                trail[goal] = None
                waiting.append(iter(rules[goal]))


# --- parts of several systems --------------------------------------------------------------------


def _conflicts(model: SmhModel) -> Iterator[Finding]:
    """Find parts of which two systems can require different states or modes at the same time."""
    wants: dict[PartName, dict[PartName, dict[StateAndMode, ModeName]]] = defaultdict(dict)
    for system in model.systems.values():
        for mode, wanted in system.modes.items():
            for part, want in wanted.items():
                wants[part].setdefault(system.name, {}).setdefault(_meaning(want), mode)
    for part, by_system in wants.items():
        (first, its), *others = by_system.items()
        for second, other in others:
            pair = _first_conflict(its, other)
            if pair is not None:
                message = (
                    f"{part} belongs to {first} and to {second}, whose requirements can conflict: "
                    f"{first} in {its[pair[0]]} requires {pair[0].label}, {second} in "
                    f"{other[pair[1]]} requires {pair[1].label}"
                )
                path = (second, "modes", other[pair[1]], part)
                yield _warning("CONFLICTING_SYSTEMS", message, *path)


def _first_conflict(
    one: Mapping[StateAndMode, ModeName], other: Mapping[StateAndMode, ModeName]
) -> tuple[StateAndMode, StateAndMode] | None:
    for want in one:
        for different in other:
            if want != different:
                return want, different
    return None
