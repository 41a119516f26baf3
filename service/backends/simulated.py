"""Simulated nodes in real time: the backend that needs no robot."""

from collections.abc import Callable

from domain.messages import BackendStatus, Command
from domain.parameters import Parameters
from domain.simulation.node_settings import Fault
from domain.simulation.nodes import SimulatedNodes
from domain.system_model import PartName
from service.clock import Clock
from service.pacing import Pacer
from service.ports import BackendMessage


class SimulatedBackend:
    """Runs `SimulatedNodes` on a clock; a `NodeBackend`."""

    def __init__(self, nodes: SimulatedNodes, clock: Clock) -> None:
        self._nodes = nodes
        self._clock = clock
        self._pacer = Pacer(nodes, clock)

    async def run(self, deliver: Callable[[BackendMessage], None]) -> None:
        """Deliver every node, then what changes, until cancelled."""
        deliver(BackendStatus(available=True))
        await self._pacer.run(deliver)

    def send(self, command: Command) -> None:
        """Ask a node for something."""
        self._nodes.handle(command, self._clock.now())
        self._pacer.touch()

    def set_fault(self, node: PartName, fault: Fault | None) -> None:
        """Let something be wrong with a node from now on; None: all is well again.

        Raises:
            UnknownPartError: There is no such node.
        """
        self._nodes.set_fault(node, fault, self._clock.now())
        self._pacer.touch()

    def set_parameters(self, node: PartName, values: Parameters) -> None:
        """Change parameters of a node from outside, all or none.

        Raises:
            UnknownPartError: There is no such node.
            UnknownParameterError: It has no such parameter.
            InvalidValueError: A value is not of the parameter's type.
            RefusedError: The node does not run.
        """
        self._nodes.set_parameters(node, values, self._clock.now())
        self._pacer.touch()
