"""What the service needs from outside, and nothing about who provides it.

An adapter hands every fact to `deliver` on the event loop's thread. What `deliver` raises is no
matter of the adapter: it ends `run`.
"""

from collections.abc import Callable
from typing import Protocol, TypeAlias

from domain.commands import Drive, NodeCommand
from domain.inputs import BackendStatus, NodeAnswer, NodeReport, Readings, VehicleReport
from domain.simulation.robot import SimulatedRobot

BackendMessage: TypeAlias = NodeReport | NodeAnswer | BackendStatus | Readings | VehicleReport


class RobotBackend(Protocol):
    """Nodes, vehicle and signals, wherever they are.

    `tests/conformance/test_node_backend.py` and `test_vehicle.py` say what each adapter must keep.
    """

    @property
    def simulation(self) -> SimulatedRobot | None:
        """Return the simulated robot behind this, which can be copied; None: a real one."""
        ...

    async def run(self, deliver: Callable[[BackendMessage], None]) -> None:
        """Deliver all there is to know, then what changes, until cancelled.

        A node that cannot be reached is delivered as such, and with all its facts when it is back.
        The vehicle is delivered at 20 Hz or so, as long as it is known where it is. Is run once; to
        end otherwise than by being cancelled is an error.
        """
        ...

    def send(self, command: NodeCommand | Drive) -> None:
        """Ask a node for something, or tell the vehicle how to drive; return at once.

        Called on the event loop's thread. Never raises for a node that is absent or unknown: a
        command that cannot be delivered gets an answer that says so, or none. The vehicle stands
        still 0.5 s after the last command to drive, so that a dead supervisor stops the robot.
        """
        ...
