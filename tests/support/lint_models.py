"""Small models for lint, and what it says about them."""

from collections.abc import Mapping
from typing import TypeVar

from domain.conditions.condition import Condition
from domain.findings import Finding
from domain.health.signals import default_signals
from domain.parameters import Parameters
from domain.parts.lint.model_lint import lint
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import NodeModel, Rule, SmhModel, SystemModel
from domain.robot_vocabulary import vocabulary_of
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

N = PartName("n")
T = TypeVar("T")


def node(name: str = "n", **modes: Parameters) -> NodeModel:
    """Return a node; `default` stands for the default mode."""
    return NodeModel(PartName(name), _with_default(modes))


def system(name: str = "s", *rules: Rule, **modes: dict[str, str]) -> SystemModel:
    """Return a system; each mode says what it requires of its parts, as labels."""
    wanted: dict[str, Mapping[PartName, StateAndMode]] = {
        mode: {PartName(part): StateAndMode.parse(label) for part, label in wants.items()}
        for mode, wants in modes.items()
    }
    return SystemModel(PartName(name), _with_default(wanted), rules)


def rule(name: str, target: str, part: str, state: str, instead: str) -> Rule:
    """Return a rule that replaces `target` by `instead` while a part is in a state."""
    parse = StateAndMode.parse
    return Rule(name, parse(target), (PartName(part), parse(state)), parse(instead))


def guarded(
    requires: str | list[str] = "", invariants: str | list[str] = "", fallback: str | None = None
) -> ModeSettings:
    """Return the settings of a mode; one text stands for one condition, none for no condition."""
    return ModeSettings(
        requires=_conditions(requires),
        invariants=_conditions(invariants),
        fallback=None if fallback is None else ModeName(fallback),
    )


def model_of(*parts: NodeModel | SystemModel, **settings: dict[str, ModeSettings]) -> SmhModel:
    """Return a model.

    Args:
        *parts: Its parts.
        **settings: Settings of modes by part.
    """
    nodes = {part.name: part for part in parts if isinstance(part, NodeModel)}
    systems = {part.name: part for part in parts if isinstance(part, SystemModel)}
    by_part = {PartName(part): _with_default(own) for part, own in settings.items()}
    return SmhModel(nodes, systems, by_part)


def lint_of(model: SmhModel) -> list[Finding]:
    """Return what lint says about a model whose signals are the usual ones."""
    return lint(model, vocabulary_of(model, default_signals(), is_complete=True))


def told(*parts: NodeModel | SystemModel, **settings: dict[str, ModeSettings]) -> list[Finding]:
    """Return what lint says about a model."""
    return lint_of(model_of(*parts, **settings))


def brief(findings: list[Finding]) -> list[tuple[str, tuple[str, ...]]]:
    """Return code and path of warnings."""
    assert {finding.severity for finding in findings} <= {"warning"}
    assert all(finding.part == finding.path[0] for finding in findings)
    return [(finding.code, finding.path) for finding in findings]


def _conditions(texts: str | list[str]) -> tuple[Condition, ...]:
    listed = [texts] if isinstance(texts, str) else texts
    return tuple(Condition.parse(text) for text in listed if text)


def _with_default(modes: Mapping[str, T]) -> dict[ModeName, T]:
    return {DEFAULT_MODE if m == "default" else ModeName(m): value for m, value in modes.items()}
