"""Commands of the supervisor, as a device judges them."""

from collections import deque
from collections.abc import Set

from domain.computers import Incarnation, Session
from domain.link.messages import NodeOrder
from domain.state_and_mode import PartName

_MAX_TAKEN = 4_096
"""Commands that may still be answered, at most."""


class Orders:
    """Takes each command of the supervisor that is followed once, in order, under one session."""

    def __init__(self, nodes: Set[PartName]) -> None:
        """Begin without a supervisor.

        Args:
            nodes: Of this device.
        """
        self._nodes = nodes
        self._process: Incarnation | None = None
        self._seq = 0
        self._taken = deque[int](maxlen=_MAX_TAKEN)
        """Numbers of requests that were taken, of this process of the supervisor."""

    def follow(self, process: Incarnation) -> None:
        """Follow a process of the supervisor; commands of others count no more."""
        if process != self._process:
            self._process = process
            self._seq = 0
            self._taken.clear()

    def is_next(self, order: NodeOrder) -> bool:
        """Tell whether a command is of that process, and comes neither twice nor late.

        One that does is not answered: its number is that of another request, or was answered.
        """
        if order.incarnation != self._process or order.seq <= self._seq:
            return False
        self._seq = order.seq
        return True

    def find_refusal(self, order: NodeOrder, session: Session) -> str | None:
        """Return why a command is not carried out; None: it may be."""
        if order.session != session:
            return "it was sent before the connection to the supervisor was lost"
        if order.command.node not in self._nodes:
            return f"{order.command.node} is not a node of this device"
        return None

    def take(self, order: NodeOrder) -> None:
        """Note that a command goes to the core."""
        self._taken.append(order.command.request)

    def is_taken(self, request: int) -> bool:
        """Tell whether the supervisor that is followed made a request, and so hears the answer."""
        return request in self._taken
