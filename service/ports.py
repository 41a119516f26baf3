"""What the service needs from outside, and nothing about who provides it.

An adapter hands every fact to `deliver` on the event loop's thread. What `deliver` raises is no
matter of the adapter: it ends `run`.
"""

from collections.abc import Callable
from typing import Protocol, TypeAlias

from domain.messages import BackendStatus, Command, NodeAnswer, NodeReport, Readings

BackendMessage: TypeAlias = NodeReport | NodeAnswer | BackendStatus


class NodeBackend(Protocol):
    """Nodes, wherever they run.

    `tests/conformance/test_node_backend.py` says what each adapter must keep.
    """

    async def run(self, deliver: Callable[[BackendMessage], None]) -> None:
        """Deliver all there is to know of every node, then what changes, until cancelled.

        A node that cannot be reached is delivered as such, and with all its facts when it is back.
        Is run once; to end otherwise than by being cancelled is an error.
        """
        ...

    def send(self, command: Command) -> None:
        """Ask a node for something, on the event loop's thread; return at once.

        Never raises for a node that is absent or unknown: a command that cannot be delivered gets
        an answer that says so, or none.
        """
        ...


class SignalSource(Protocol):
    """Something that measures signals."""

    async def run(self, deliver: Callable[[Readings], None]) -> None:
        """Deliver readings until cancelled; to end otherwise is an error."""
        ...
