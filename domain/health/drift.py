"""Which parameters of a node differ from those that its target mode requires."""

from typing import NamedTuple

from domain.findings import Fact
from domain.lifecycle import LifecycleState
from domain.parameters import ParameterValue, same_value
from domain.parts.parts import Parts
from domain.state_and_mode import DEFAULT_MODE, PartName


class Drift(NamedTuple):
    """The first parameter that drifted, and how many did."""

    message: str
    value: Fact
    """The reported value; None: it is a list."""
    wanted: Fact
    """The required value; None: it is a list."""


def drifted_parameter(parts: Parts, node: PartName) -> Drift | None:
    """Return which parameter of a node has another value than its target mode requires.

    A parameter that was never reported has not drifted; a target in which the node is not active
    requires none.
    """
    target, modes = parts.target(node), parts.model.nodes[node].modes
    if target is None or target.state is not LifecycleState.ACTIVE:
        return None
    mode = target.mode or DEFAULT_MODE
    wanted, known = modes.get(mode, {}), parts.facts[node].parameters
    actual = parts.inference.actual(node)
    if actual.mode == mode and actual.mode_inferred:
        return None  # Inferred from these very values.
    drifted = [
        name for name in wanted if name in known and not same_value(known[name], wanted[name])
    ]
    if not drifted:
        return None
    first = drifted[0]
    more = f", and {len(drifted) - 1} more" if len(drifted) > 1 else ""
    message = f"{first} is {known[first]}, {mode} requires {wanted[first]}{more}"
    return Drift(message, _plain(known[first]), _plain(wanted[first]))


def _plain(value: ParameterValue) -> Fact:
    return None if isinstance(value, tuple) else value
