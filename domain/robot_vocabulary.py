"""What conditions can name on a robot: the parts of its model, its signals and their errors."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol

from domain.conditions.vocabulary import Kind, PartTerms, Terms, Vocabulary
from domain.health.built_in_errors import ALL_OF_NODES, OF_EVERY_PART
from domain.health.signals import STALE_DATA, SignalKind, SignalSettings, SignalSpec
from domain.parameters import ParameterValue
from domain.parts.declared_errors import DeclaredError
from domain.parts.system_model import NodeModel, SystemModel
from domain.state_and_mode import PartName

_OF_EVERY_PART = tuple(OF_EVERY_PART)
_OF_NODES = tuple(ALL_OF_NODES)


class PartsOfRobot(Protocol):
    """The parts of a model, which may have errors."""

    @property
    def nodes(self) -> Mapping[PartName, NodeModel]:
        """Return the nodes by name."""
        ...

    @property
    def errors(self) -> Mapping[PartName, Mapping[str, DeclaredError]]:
        """Return the errors that parts declare, by name."""
        ...

    @property
    def systems(self) -> Mapping[PartName, SystemModel]:
        """Return the systems by name."""
        ...


def vocabulary_of(
    model: PartsOfRobot, signals: Iterable[SignalSettings], *, is_complete: bool
) -> Vocabulary:
    """Return what conditions can name.

    Args:
        model: Its systems and nodes.
        signals: Those that are known.
        is_complete: All signals are known; False: a robot file may declare more.
    """
    known = tuple(signals)
    of_signals = _errors_of(known)

    def errors(part: PartName, built_in: tuple[str, ...]) -> tuple[str, ...]:
        own = (*model.errors.get(part, ()), *of_signals.get(part, ()))
        # Most parts have none of their own, and share one tuple.
        return tuple(dict.fromkeys((*built_in, *own))) if own else built_in

    parts = {
        str(name): _terms_of_node(node, errors(name, _OF_NODES))
        for name, node in model.nodes.items()
    }
    for name, system in model.systems.items():
        modes, own = tuple(map(str, system.modes)), errors(name, _OF_EVERY_PART)
        parts[str(name)] = PartTerms(is_node=False, modes=modes, errors=own)
    return Vocabulary(
        parts,
        {signal.spec.name: _terms_of_signal(signal.spec) for signal in known},
        (*dict.fromkeys(of_signals.get(None, ())), STALE_DATA),
        is_complete,
    )


def _errors_of(signals: Iterable[SignalSettings]) -> Mapping[PartName | None, Sequence[str]]:
    """Return by part the errors that signals raise, but stale data; None: the robot's own."""
    errors: dict[PartName | None, list[str]] = {}
    for signal in signals:
        for key, _ in signal.can_raise().values():
            if key.error != STALE_DATA:
                errors.setdefault(key.part, []).append(key.error)
    return errors


def _terms_of_node(node: NodeModel, errors: tuple[str, ...]) -> PartTerms:
    parameters: dict[str, Terms | None] = {}
    for values in node.modes.values():
        for name, value in values.items():
            parameters.setdefault(name, _terms_of_value(value))
    return PartTerms(
        is_node=True,
        modes=tuple(map(str, node.modes)),
        parameters=parameters,
        errors=errors,
    )


def _terms_of_value(value: ParameterValue) -> Terms | None:
    match value:
        case bool():
            return Terms(Kind.BOOLEAN)
        case int() | float():
            return Terms(Kind.NUMBER)
        case str():
            return Terms(Kind.WORD)
        case _:
            return None


def _terms_of_signal(spec: SignalSpec) -> Terms:
    match spec.kind:
        case SignalKind.NUMBER:
            return Terms(Kind.NUMBER, spec.minimum, spec.maximum)
        case SignalKind.BOOLEAN:
            return Terms(Kind.BOOLEAN)
        case SignalKind.ENUMERATION:
            return Terms(Kind.WORD, words=spec.members)
