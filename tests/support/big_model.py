"""A model of any size: a balanced tree of systems with ten parts each, three modes everywhere.

The shape of the measurements of micro-ROS system_modes: 10,000 nodes are under 1,111 systems.
"""

from collections.abc import Mapping

from domain.lifecycle import LifecycleState
from domain.parameters import Parameters
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

FAN_OUT = 10
FAST, SLOW = ModeName("FAST"), ModeName("SLOW")
MODES = (DEFAULT_MODE, FAST, SLOW)
PARAMETERS: Mapping[ModeName, Parameters] = {
    mode: {"max_speed": 0.1 + number, "controller": f"PID_{number}"}
    for number, mode in enumerate(MODES)
}
"""Of every node."""


def big_model(nodes: int) -> SmhModel:
    """Return a model of so many nodes; the root is the first of its systems."""
    return SmhModel(
        {node: NodeModel(node, PARAMETERS) for node in _nodes(nodes)},
        {
            system: SystemModel(
                system,
                {m: {p: StateAndMode(LifecycleState.ACTIVE, m) for p in parts} for m in MODES},
            )
            for system, parts in _systems(nodes).items()
        },
    )


def big_model_text(nodes: int) -> str:
    """Return the same model as YAML."""
    lines: list[str] = []
    for system, parts in _systems(nodes).items():
        lines += [f"{system}:", "  ros__parameters:", "    type: system"]
        lines += [f"    parts: [{', '.join(parts)}]", "    modes:"]
        for mode in MODES:
            lines += [f"      {mode}:", *(f"        {part}: active.{mode}" for part in parts)]
    for node in _nodes(nodes):
        lines += [f"{node}:", "  ros__parameters:", "    type: node", "    modes:"]
        for mode, parameters in PARAMETERS.items():
            lines += [f"      {mode}:", "        ros__parameters:"]
            lines += [f"          {name}: {value}" for name, value in parameters.items()]
    return "\n".join([*lines, ""])


def _nodes(count: int) -> list[PartName]:
    return [PartName(f"node_{number}") for number in range(count)]


def _systems(nodes: int) -> dict[PartName, list[PartName]]:
    """Return the parts of each system, the root first."""
    systems: dict[PartName, list[PartName]] = {}
    below, level = _nodes(nodes), 0
    while len(below) > 1:
        level += 1
        groups = [below[start : start + FAN_OUT] for start in range(0, len(below), FAN_OUT)]
        below = [PartName(f"system_{level}_{number}") for number in range(len(groups))]
        systems = {**dict(zip(below, groups, strict=True)), **systems}
    return systems
