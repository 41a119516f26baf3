"""The simulated robot: nodes, vehicle and mock signals, advanced together.

Together, so that messages at the same instant have the same order live and in a simulation: nodes,
signals, vehicle.
"""

from collections.abc import Mapping
from typing import TypeAlias

from domain.commands import Drive, NodeCommand
from domain.inputs import Readings, VehicleReport
from domain.parts.system_model import SmhModel
from domain.simulation.memory import read_memory
from domain.simulation.mock_signals import MockSignals
from domain.simulation.node_settings import NodeSettings
from domain.simulation.nodes import NodeMessage, SimulatedNodes
from domain.simulation.vehicle import SimulatedVehicle
from domain.simulation.vehicle_settings import VehicleSettings
from domain.state_and_mode import PartName
from domain.timebase import Instant

RobotMessage: TypeAlias = NodeMessage | Readings | VehicleReport

_NO_NODES: Mapping[PartName, NodeSettings] = {}


class SimulatedRobot:
    """All simulated parts of a robot. `now` must never decrease from call to call.

    Raises:
        UnknownPartError: There are settings of a node that the model does not have.
    """

    def __init__(
        self,
        model: SmhModel,
        start: Instant,
        nodes: Mapping[PartName, NodeSettings] = _NO_NODES,
        vehicle: VehicleSettings | None = None,
        *,
        mock: bool = False,
        memory: object = None,
    ) -> None:
        """Begin at `start`.

        Args:
            model: The nodes to simulate.
            start: The current time.
            nodes: Settings of the nodes that differ from the default.
            vehicle: Settings of the vehicle; None: an ideal one at the origin.
            mock: Whether to publish the five mock signals.
            memory: `nodes` and `vehicle` as they were in an earlier run, so that both are where
                they were, at standstill; None: they begin anew.
        """
        remembered = read_memory(memory, model)
        self.left_out = remembered.left_out
        """What could not be read of the memory, and why, in words."""
        self.nodes = SimulatedNodes(model, nodes, start, remembered.nodes)
        self.mock = MockSignals(start) if mock else None
        self.vehicle = SimulatedVehicle(vehicle or VehicleSettings(), start, remembered.vehicle)

    @property
    def what(self) -> tuple[str, ...]:
        """Return which parts of the robot are simulated, for clients."""
        return ("nodes", "vehicle") if self.mock is None else ("nodes", "signals", "vehicle")

    def handle(self, command: NodeCommand | Drive, now: Instant) -> None:
        """Accept a command for a node or the vehicle."""
        if isinstance(command, Drive):
            self.vehicle.drive(command.command, now)
        else:
            self.nodes.handle(command, now)

    def advance(self, now: Instant) -> tuple[RobotMessage, ...]:
        """Return all messages due up to `now`."""
        readings = () if self.mock is None else self.mock.advance(now)
        return (*self.nodes.advance(now), *readings, *self.vehicle.advance(now))

    def wake_at(self) -> Instant:
        """Return when something is due next."""
        due = self.vehicle.wake_at()
        if self.mock is not None:
            due = min(due, self.mock.wake_at())
        nodes = self.nodes.wake_at()
        return due if nodes is None else min(due, nodes)
