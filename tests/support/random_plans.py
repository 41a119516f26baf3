"""Robots of random nested systems whose parts change in random orders."""

import hypothesis.strategies as st

from domain.parts.mode_settings import ModeSettings, OnFailure, TransitionSettings
from domain.parts.system_model import EVERY_MODE, NodeModel, SmhModel, SystemModel
from domain.simulation.node_settings import NodeSettings
from domain.state_and_mode import DEFAULT_MODE, PartName
from domain.timebase import seconds
from tests.support.models import FAST, active

ROOT = PartName("s0")
_TIMES = st.sampled_from([0.0, 0.1, 0.3, 1.0]).map(seconds)


@st.composite
def planned_models(draw: st.DrawFn, on_failure: OnFailure = OnFailure.CONTINUE) -> SmhModel:
    """Return a tree of systems, in each of which parts wait for some that stand before them."""
    parts: dict[PartName, list[PartName]] = {ROOT: []}
    for number in range(draw(st.integers(0, 3))):
        parent = draw(st.sampled_from(sorted(parts)))
        name = PartName(f"s{number + 1}")
        parts[name] = []
        parts[parent].append(name)
    for name, below in parts.items():
        below += [PartName(f"{name}_n{number}") for number in range(draw(st.integers(1, 3)))]
    settings = {
        name: {
            EVERY_MODE: ModeSettings(
                transition=TransitionSettings(
                    {
                        part: tuple(draw(st.lists(st.sampled_from(below[:place]), unique=True)))
                        for place, part in enumerate(below)
                        if place
                    },
                    on_failure=on_failure,
                )
            )
        }
        for name, below in parts.items()
    }
    modes = {DEFAULT_MODE: {"speed": 0.1}, FAST: {"speed": 0.9}}
    nodes = [part for below in parts.values() for part in below if part not in parts]
    systems = {
        name: SystemModel(name, {mode: {part: active(mode) for part in below} for mode in modes})
        for name, below in parts.items()
    }
    return SmhModel({node: NodeModel(node, modes) for node in nodes}, systems, settings)


@st.composite
def node_times(draw: st.DrawFn, model: SmhModel) -> dict[str, NodeSettings]:
    """Return how long each node needs for its steps."""
    return {
        node: NodeSettings(
            configure=draw(_TIMES),
            activate=draw(_TIMES),
            deactivate=draw(_TIMES),
            set_parameters=draw(_TIMES),
        )
        for node in model.nodes
    }


def waits(model: SmhModel) -> list[tuple[PartName, PartName]]:
    """Return each part that waits, with each of those that it waits for."""
    return [
        (part, name)
        for system in model.systems
        for part, before in model.settings_of(system, DEFAULT_MODE).transition.after.items()
        for name in before
    ]
