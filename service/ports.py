"""What the service needs from outside, and nothing about who provides it.

An adapter hands every fact to `deliver` on the event loop's thread. What `deliver` raises is no
matter of the adapter: it ends `run`. One adapter may provide several of these ports.
"""

from collections.abc import Callable
from typing import Protocol, TypeAlias

from domain.commands import Drive, NodeCommand
from domain.inputs import BackendStatus, NodeAnswer, NodeReport, Readings, VehicleReport

BackendMessage: TypeAlias = NodeReport | NodeAnswer | BackendStatus | Readings | VehicleReport
Deliver: TypeAlias = Callable[[BackendMessage], None]


class Adapter(Protocol):
    """Something that facts about the robot come from."""

    async def run(self, deliver: Deliver) -> None:
        """Deliver all there is to know, then what changes, until cancelled.

        Is run once; to end otherwise than by being cancelled is an error.
        """
        ...


class NodeBackend(Adapter, Protocol):
    """Nodes, wherever they are; `tests/conformance/test_node_backend.py` says what it must keep.

    It delivers `BackendStatus`, `NodeReport` and `NodeAnswer`. A node that cannot be reached is
    delivered as such, and with all its facts when it is back.
    """

    def send(self, command: NodeCommand, /) -> None:
        """Ask a node for something; return at once.

        Called on the event loop's thread. Never raises for a node that is absent or unknown: a
        command that cannot be delivered gets an answer that says so, or none.
        """
        ...


class VehicleBackend(Adapter, Protocol):
    """The vehicle; `tests/conformance/test_vehicle.py` says what it must keep.

    It delivers a `VehicleReport` at 20 Hz or so, as long as the pose of the vehicle is known.
    """

    def send(self, command: Drive, /) -> None:
        """Command speed and steering angle; return at once.

        Called on the event loop's thread. The vehicle stands still 0.5 s after the last command to
        drive, so that a dead supervisor stops the robot.
        """
        ...


class SignalSource(Adapter, Protocol):
    """Where readings of signals come from; it delivers `Readings`."""


class RobotBackend(Adapter, Protocol):
    """Nodes, vehicle and signals together, as the supervisor sees them."""

    def send(self, command: NodeCommand | Drive, /) -> None:
        """Pass a command on to a node or to the vehicle; return at once. Never raises."""
        ...
