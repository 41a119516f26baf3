"""Random models, and random histories of what happens to the robots that they describe."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import hypothesis.strategies as st

from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parameters import Parameters, ParameterValue
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode


@dataclass(frozen=True)
class SetTarget:
    """A part is asked for something, or no longer."""

    part: PartName
    target: StateAndMode | None


Happening: TypeAlias = NodeReport | SetTarget

MODES = [ModeName(name) for name in ("A", "a", "Z", "_B")]
"""Upper case, underscore and lower case: in byte order `A Z _B a`, around `__DEFAULT__`."""
VALUES: st.SearchStrategy[ParameterValue] = st.sampled_from([0, 1, 1.0, True, "x", (1, 2)])
PARAMETERS: st.SearchStrategy[Parameters] = st.dictionaries(
    st.sampled_from(["p", "q"]), VALUES, max_size=2
)


@st.composite
def models(draw: st.DrawFn) -> SmhModel:
    """Return a model of some nodes and of systems over them and over each other."""
    nodes = {}
    for number in range(draw(st.integers(1, 4))):
        name = PartName(f"n{number}")
        nodes[name] = NodeModel(name, _node_modes(draw))
    systems: dict[PartName, SystemModel] = {}
    for number in range(draw(st.integers(1, 4))):
        # Not in the order of the hierarchy, so that none of the code may rely on it.
        name = PartName(f"{draw(st.sampled_from('abz'))}{number}")
        modes_of = {
            **{part: list(node.modes) for part, node in nodes.items()},
            **{part: list(system.modes) for part, system in systems.items()},
        }
        systems[name] = SystemModel(name, _system_modes(draw, modes_of))
    return SmhModel(nodes, dict(reversed(systems.items())))


def _node_modes(draw: st.DrawFn) -> Mapping[ModeName, Parameters]:
    if draw(st.integers(0, 5)) == 0:
        return {}
    names = [DEFAULT_MODE, *draw(st.lists(st.sampled_from(MODES), unique=True, max_size=3))]
    return {name: draw(PARAMETERS) for name in names}


def _system_modes(
    draw: st.DrawFn, modes_of: Mapping[PartName, list[ModeName]]
) -> Mapping[ModeName, Mapping[PartName, StateAndMode]]:
    names = [DEFAULT_MODE, *draw(st.lists(st.sampled_from(MODES), unique=True, max_size=2))]
    known = st.sampled_from(list(modes_of))
    parts = draw(st.lists(known, unique=True, min_size=1, max_size=3))
    # A mode may name a part that `__DEFAULT__` does not.
    more = {name: draw(st.lists(known, max_size=1)) for name in names if name != DEFAULT_MODE}
    return {
        name: {
            part: draw(_wanted(modes_of[part]))
            for part in dict.fromkeys([*parts, *more.get(name, ())])
        }
        for name in names
    }


def _wanted(modes: list[ModeName]) -> st.SearchStrategy[StateAndMode]:
    choices: Sequence[ModeName | None] = modes or [None]
    active = [StateAndMode(LifecycleState.ACTIVE, mode) for mode in choices]
    return st.sampled_from([*active, *active, StateAndMode(LifecycleState.INACTIVE)])


def model_text(model: SmhModel) -> str:
    """Return a model as YAML."""
    text = {
        **{part: _node_block(node) for part, node in model.nodes.items()},
        **{part: _system_block(system) for part, system in model.systems.items()},
    }
    # JSON is YAML.
    return json.dumps({part: {"ros__parameters": block} for part, block in text.items()})


def _node_block(node: NodeModel) -> Mapping[str, object]:
    # In a file, every mode has parameters, and `__DEFAULT__` has all of them.
    every = {name: value for values in node.modes.values() for name, value in values.items()}
    of_mode = {mode: {"r": 0, **values} for mode, values in node.modes.items()}
    if of_mode:
        of_mode[DEFAULT_MODE] = {**every, **of_mode[DEFAULT_MODE]}
    modes = {mode: {"ros__parameters": values} for mode, values in of_mode.items()}
    return {"type": "node", "modes": modes} if modes else {"type": "node"}


def _system_block(system: SystemModel) -> Mapping[str, object]:
    modes = {
        mode: {part: want.label for part, want in wanted.items()}
        for mode, wanted in system.modes.items()
    }
    return {"type": "system", "modes": modes}


@st.composite
def histories(draw: st.DrawFn, model: SmhModel) -> list[Happening]:
    """Return what happens to the parts of `model`; now and then all of them do what is wanted."""
    happenings: list[Happening] = []
    for _ in range(draw(st.integers(1, 12))):
        kind = draw(st.sampled_from(["report", "report", "target", "obey", "obey"]))
        if kind == "report":
            happenings.append(draw(_reports(model)))
        elif kind == "target":
            part = draw(st.sampled_from(model.parts))
            happenings.append(SetTarget(part, draw(_targets(model, part))))
        else:
            system = draw(st.sampled_from(list(model.systems)))
            mode = draw(st.sampled_from(list(model.systems[system].modes)))
            happenings += _obeyed(model, system, StateAndMode(LifecycleState.ACTIVE, mode))
    return happenings


def _reports(model: SmhModel) -> st.SearchStrategy[NodeReport]:
    return st.builds(
        NodeReport,
        st.sampled_from(list(model.nodes)),
        state=st.none() | st.sampled_from(LifecycleState),
        mode=st.none() | st.sampled_from([DEFAULT_MODE, *MODES]),
        parameters=st.none() | PARAMETERS,
        reachable=st.sampled_from([None, None, None, True, False]),
        has_lifecycle=st.sampled_from([None, None, None, True, False]),
    )


def _targets(model: SmhModel, part: PartName) -> st.SearchStrategy[StateAndMode | None]:
    active = [StateAndMode(LifecycleState.ACTIVE, mode) for mode in (None, *model.modes_of(part))]
    others = [StateAndMode(state) for state in LifecycleState if state is not LifecycleState.ACTIVE]
    return st.none() | st.sampled_from(active) | st.sampled_from(others)


def _obeyed(model: SmhModel, part: PartName, wanted: StateAndMode) -> list[Happening]:
    """Return that `wanted` is asked of a part and of those below, and that the nodes are there."""
    happened: list[Happening] = [SetTarget(part, wanted)]
    if part in model.nodes:
        modes = model.nodes[part].modes
        report = NodeReport(
            part,
            state=wanted.state,
            parameters=modes[wanted.mode] if wanted.mode else None,
            reachable=True,
            has_lifecycle=True,
        )
        return [*happened, report]
    system = model.systems[part]
    below = system.modes[wanted.mode] if wanted.mode else dict.fromkeys(system.parts, wanted)
    for child, want in below.items():
        happened += _obeyed(model, child, want)
    return happened
