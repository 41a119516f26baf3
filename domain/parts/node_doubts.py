"""What keeps a node from being where it is needed, as one reason."""

from collections.abc import Sequence
from dataclasses import replace

from domain.findings import Blocker
from domain.lifecycle import LifecycleState
from domain.parts.node_facts import NodeFacts
from domain.state_and_mode import PartName

UNREACHABLE = "UNREACHABLE"
UNKNOWN_STATE = "UNKNOWN_STATE"
ERROR_PROCESSING = "ERROR_PROCESSING"
DEVICE_LOST = "DEVICE_LOST"
"""Code of what a node that cannot be heard follows from."""
_STUCK = {
    LifecycleState.FINALIZED: ("FINALIZED", "is finalized: its process must be restarted"),
    LifecycleState.ERROR_PROCESSING: (ERROR_PROCESSING, "is processing an error"),
}

IN_DOUBT = frozenset({LifecycleState.UNKNOWN, *_STUCK})
"""Known states of a node that cannot go anywhere, or is not known to."""


def doubt_of(node: PartName, facts: NodeFacts, path: Sequence[str]) -> Blocker | None:
    """Return why a node cannot go anywhere, or is not known to; None: it can.

    Args:
        node: Its name.
        facts: What it reported.
        path: Parts from the one that is asked about down to the node.
    """
    state = facts.known_state
    causes: tuple[Blocker, ...] = ()
    if state is LifecycleState.UNKNOWN:
        code = UNREACHABLE if facts.reachable is False else UNKNOWN_STATE
        words, value = facts.why_unknown, None
        if facts.cut_off is not None:
            causes = (replace(facts.cut_off, path=tuple(path)),)
    elif state in _STUCK:
        code, words = _STUCK[state]
        value = str(state)
    else:
        return None
    return Blocker(
        code,
        f"{node} {words}",
        tuple(path),
        value,
        since=facts.state_since,
        root_cause=not causes,
        causes=causes,
    )
