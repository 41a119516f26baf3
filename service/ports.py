"""The ports of the service; adapters implement them.

An adapter passes every fact to `deliver` on the event loop's thread. It does not catch what
`deliver` raises: that ends `run`. One adapter may provide several ports.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from domain.commands import (
    Drive,
    LinkCommand,
    NodeCommand,
    PreemptGoal,
    ProcessCommand,
    SendGoal,
)
from domain.computers import ComputerName, Connection
from domain.controller import ControllerMessage
from domain.graph_terms import GraphFault
from domain.inputs import (
    BackendStatus,
    DeviceStatus,
    DriveStatus,
    ErrorReport,
    Input,
    NodeAnswer,
    NodeReport,
    OrderReceived,
    PeerStops,
    ReactionReport,
    Readings,
    ReportBacklog,
    SourceFault,
    StopsReleased,
    SupervisorStatus,
    VehicleReport,
)
from domain.process_terms import ProcessReport
from domain.state_and_mode import PartName

BackendMessage: TypeAlias = (
    NodeReport
    | NodeAnswer
    | BackendStatus
    | ReportBacklog
    | Readings
    | SourceFault
    | ErrorReport
    | ProcessReport
    | VehicleReport
    | DriveStatus
    | ControllerMessage
    | GraphFault
    | DeviceStatus
    | SupervisorStatus
    | PeerStops
    | StopsReleased
    | OrderReceived
    | ReactionReport
)
Deliver: TypeAlias = Callable[[BackendMessage], None]


@dataclass(frozen=True, slots=True)
class ProcessOutput:
    """The last lines that a process of a node printed, stdout and stderr together."""

    running: Sequence[str]
    """Of the process that runs."""
    ended: Sequence[str]
    """Of the one that ended last."""


class Adapter(Protocol):
    """A source of facts about the robot."""

    async def run(self, deliver: Deliver) -> None:
        """Deliver the current state, then every change, until cancelled.

        Called once. Returning without being cancelled is an error.
        """
        ...


class NodeBackend(Adapter, Protocol):
    """The nodes; `tests/conformance/test_node_backend.py` specifies what an adapter must do.

    It delivers `BackendStatus`, `NodeReport` and `NodeAnswer`. A node that cannot be reached is
    reported as unreachable; when it reappears, all its facts are reported. If more has arrived than
    it delivers in one turn, it says so by `ReportBacklog`: no node is late meanwhile.
    """

    def send(self, command: NodeCommand, /) -> None:
        """Send a command to a node, and return at once.

        Called on the event loop's thread. Never raises for a node that is absent or unknown: a
        command that cannot be delivered gets a negative answer, or none.
        """
        ...


class VehicleBackend(Adapter, Protocol):
    """The vehicle; `tests/conformance/test_vehicle.py` specifies what an adapter must do.

    It delivers a `VehicleReport` at about 20 Hz while the pose of the vehicle is known, and a
    `DriveStatus` when commands no longer reach the vehicle, or reach it again.
    """

    def send(self, command: Drive, /) -> None:
        """Command speed and steering angle, and return at once.

        Called on the event loop's thread. A command is valid for 0.5 s: then speed 0 is commanded,
        so that the robot stops when the supervisor dies.
        """
        ...


class NavigationBackend(Protocol):
    """An external controller; `tests/conformance/test_navigation.py` specifies what is asked of it.

    The adapter only carries messages; the core judges them, and every deadline. It delivers
    `ControllerStatus` whether there is a controller, which has confirmed before that it has none of
    our goals; of each goal one `ControllerAnswer`, `ControllerFeedback` at 25 Hz at most, and one
    `ControllerResult`.
    """

    def send(self, command: SendGoal | PreemptGoal, /) -> None:
        """Send a goal, or ask for its end, and return at once. Never raises.

        Called on the event loop's thread. The end may be asked for several times: of a goal that
        the controller does not have, `ControllerResult` says so.
        """
        ...


class SignalSource(Adapter, Protocol):
    """A source of signal readings; it delivers `Readings`, or `SourceFault` if it has none."""


class ComputersLink(Adapter, Protocol):
    """The other computers of the robot; `service/link` has both ends of it.

    It delivers what the core of this computer must know of the others: on the supervisor
    `DeviceStatus`, on a device `SupervisorStatus` and `OrderReceived`, on both `PeerStops` and
    `StopsReleased`.
    """

    def send(self, command: LinkCommand, /) -> None:
        """Tell other computers, and return at once. Never raises."""
        ...

    def connection(self, computer: ComputerName, /) -> Connection:
        """Return how the connection to another computer is doing."""
        ...

    def note(self, given: Input, /) -> None:
        """Learn what the core of this computer took in, after what followed from it was done.

        A device tells the supervisor what that says of its nodes and signals.
        """
        ...


class ProcessRunner(Adapter, Protocol):
    """The processes of nodes. It delivers `ProcessReport`: first that none runs, then each change.

    When `run` is cancelled, it ends them all, and returns once they have ended.
    """

    def send(self, command: ProcessCommand, /) -> None:
        """Start or stop a process, and return at once. Never raises."""
        ...

    def output(self, node: PartName, /) -> ProcessOutput:
        """Return what the process of a node printed; it must be one that is run here."""
        ...


class RobotBackend(Adapter, Protocol):
    """Nodes, vehicle and signals behind one port, for the supervisor."""

    def send(self, command: NodeCommand | Drive, /) -> None:
        """Pass a command on to a node or to the vehicle; return at once. Never raises."""
        ...
