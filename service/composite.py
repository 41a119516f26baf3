"""Several adapters as one robot: nodes, vehicle and signals may each come from elsewhere."""

from collections.abc import Mapping, Sequence

from domain.commands import Drive, NodeCommand
from domain.state_and_mode import PartName
from service.ports import Adapter, Deliver, NodeBackend, SignalSource, VehicleBackend
from service.running import run_forever


class CompositeRobot:
    """A `RobotBackend` that routes node commands by node, and drive commands to the vehicle.

    An adapter that provides several ports is run once.
    """

    def __init__(
        self,
        nodes: Mapping[PartName, NodeBackend],
        vehicle: VehicleBackend | None = None,
        signals: Sequence[SignalSource] = (),
    ) -> None:
        """Prepare; nothing runs yet.

        Args:
            nodes: The backend of each node.
            vehicle: None: the robot has no vehicle, and drive commands are discarded.
            signals: The sources of readings.
        """
        self._nodes = nodes
        self._vehicle = vehicle
        vehicles = () if vehicle is None else (vehicle,)
        self._adapters: dict[int, Adapter] = {
            id(adapter): adapter for adapter in (*nodes.values(), *vehicles, *signals)
        }

    async def run(self, deliver: Deliver) -> None:
        """Deliver the messages of all adapters, until cancelled.

        Raises:
            ExceptionGroup: Of `TaskFailedError`: an adapter ended, which ends the others.
        """
        work = {}
        for number, adapter in enumerate(self._adapters.values(), start=1):
            work[f"{type(adapter).__name__} {number}"] = adapter.run(deliver)
        await run_forever(work)

    def send(self, command: NodeCommand | Drive, /) -> None:
        """Pass a command on; a command for a node without a backend gets no answer."""
        if isinstance(command, Drive):
            if self._vehicle is not None:
                self._vehicle.send(command)
        elif command.node in self._nodes:
            self._nodes[command.node].send(command)
