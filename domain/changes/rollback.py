"""Where the nodes of a change that failed were before, and so go back to."""

from domain.changes.plan import NodeGoal
from domain.changes.record import Change, NodeBefore
from domain.lifecycle import arrival
from domain.state_and_mode import PartName


def goals_before(change: Change) -> dict[PartName, NodeGoal]:
    """Return the state, mode and parameters of each node that was asked for something, as before.

    A node that was asked for nothing is where it was, and is left alone.
    """
    return {
        node: _goal(pursuit.before)
        for node, pursuit in change.pursuits.items()
        if pursuit is not None and pursuit.before is not None
    }


def _goal(before: NodeBefore) -> NodeGoal:
    return NodeGoal(arrival(before.state), before.mode, before.parameters)
