"""Modes that inference cannot tell apart."""

from collections.abc import Hashable, Iterator, Mapping

from domain.findings import Finding
from domain.lifecycle import LifecycleState
from domain.parameters import value_type
from domain.parts.lint.warning import meaning, warning
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.state_and_mode import ModeName, PartName, StateAndMode


def modes_alike(model: SmhModel) -> Iterator[Finding]:
    """Yield a warning for each mode that looks as an earlier one does.

    A system looks as its parts do, so that modes that name modes of a part that are alike are
    alike, too.
    """
    first: dict[PartName, dict[ModeName, ModeName]] = {}
    for part in _parts_first(model):
        if part in model.nodes:
            looks = _looks_of_node(model.nodes[part])
        else:
            looks = _looks_of_system(model.systems[part], first)
        known: dict[Hashable, ModeName] = {}
        first[part] = {mode: known.setdefault(look, mode) for mode, look in looks}
    for part in (*model.nodes, *model.systems):
        for mode, other in first[part].items():
            if other != mode:
                message = (
                    f"{part}: {mode} is the same as {other}; inference cannot tell the two apart"
                )
                yield warning("MODES_ALIKE", message, part, "modes", mode)


def _parts_first(model: SmhModel) -> Iterator[PartName]:
    """Yield all parts, each before the systems that it belongs to."""
    done: set[PartName] = set()
    for name in (*model.nodes, *model.systems):
        waiting = [name]
        while waiting:
            part = waiting[-1]
            system = model.systems.get(part)
            below = () if system is None else system.named_parts
            missing = [other for other in below if other not in done]
            if part in done or not missing:
                waiting.pop()
                if part not in done:
                    done.add(part)
                    yield part
            else:
                waiting.extend(missing)


def _looks_of_node(node: NodeModel) -> Iterator[tuple[ModeName, Hashable]]:
    """Yield each mode with what tells it apart: types and values of its parameters."""
    for mode, parameters in node.modes.items():
        yield mode, frozenset((n, value_type(v), v) for n, v in parameters.items())


def _looks_of_system(
    system: SystemModel, first: Mapping[PartName, Mapping[ModeName, ModeName]]
) -> Iterator[tuple[ModeName, Hashable]]:
    for mode, wanted in system.modes.items():
        yield mode, frozenset((part, _look(want, first[part])) for part, want in wanted.items())


def _look(want: StateAndMode, first: Mapping[ModeName, ModeName]) -> StateAndMode:
    """Return the state with the first mode that looks as the wanted one does."""
    pair = meaning(want)
    if pair.state is not LifecycleState.ACTIVE or pair.mode is None:
        return pair
    return StateAndMode(pair.state, first.get(pair.mode, pair.mode))
