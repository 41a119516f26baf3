"""The simulated robot in real time: a backend without a real robot."""

from domain.commands import Drive, NodeCommand
from domain.inputs import BackendStatus, ReportBacklog
from domain.parameters import Parameters
from domain.simulation.node_settings import Fault
from domain.simulation.robot import SimulatedRobot
from domain.state_and_mode import PartName
from service.clock import Clock
from service.pacing import Pacer
from service.ports import Deliver
from service.readings import DirectReadings, ReadingInput, Submit
from service.simulation.mock_source import MockHandle


class SimulatedBackend:
    """Runs a `SimulatedRobot` on a clock: nodes, vehicle and, if it has them, mock signals.

    One adapter for all, since messages of the same instant have one order.
    """

    def __init__(self, robot: SimulatedRobot, clock: Clock) -> None:
        self.robot = robot
        self._clock = clock
        self._pacer = Pacer(robot, clock)
        self.mock = None if robot.mock is None else MockHandle(robot.mock, clock, self._pacer.touch)
        """Controls the mock signals; None: there are none."""

    async def run(self, deliver: Deliver) -> None:
        """Deliver the state of every node and of the vehicle, then changes, until cancelled."""
        deliver(BackendStatus(available=True))
        await self._pacer.run(deliver, lambda since: deliver(ReportBacklog("simulated", since)))

    def readings(self, submit: Submit) -> ReadingInput:
        """Return the input for external readings."""
        return DirectReadings(submit) if self.mock is None else self.mock.readings(submit)

    def send(self, command: NodeCommand | Drive, /) -> None:
        """Send a command to a node or to the vehicle."""
        self.robot.handle(command, self._clock.now())
        self._pacer.touch()

    def set_fault(self, node: PartName, fault: Fault | None) -> None:
        """Inject a fault into a node; None: end it.

        Raises:
            UnknownPartError: There is no such node.
        """
        self.robot.nodes.set_fault(node, fault, self._clock.now())
        self._pacer.touch()

    def set_parameters(self, node: PartName, values: Parameters) -> None:
        """Change parameters of a node as another program would, all or none.

        Raises:
            UnknownPartError: There is no such node.
            UnknownParameterError: It has no such parameter.
            InvalidValueError: A value does not have the type of its parameter.
            RefusedError: The node is not running.
        """
        self.robot.nodes.set_parameters(node, values, self._clock.now())
        self._pacer.touch()

    def set_vehicle_reporting(self, reporting: bool) -> None:
        """Stop or resume the odometry of the vehicle."""
        self.robot.vehicle.set_reporting(reporting, self._clock.now())
        self._pacer.touch()
