"""The simulated robot in real time: the backend that needs no robot."""

from domain.commands import Drive, NodeCommand
from domain.inputs import BackendStatus
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

    As one adapter, since what several of them say at the same instant has one order.
    """

    def __init__(self, robot: SimulatedRobot, clock: Clock) -> None:
        self.robot = robot
        self._clock = clock
        self._pacer = Pacer(robot, clock)
        self.mock = None if robot.mock is None else MockHandle(robot.mock, clock, self._pacer.touch)
        """What can be done to the mock signals; None: there are none."""

    async def run(self, deliver: Deliver) -> None:
        """Deliver every node and the vehicle, then what changes, until cancelled."""
        deliver(BackendStatus(available=True))
        await self._pacer.run(deliver)

    def readings(self, submit: Submit) -> ReadingInput:
        """Return where readings from outside are handed in."""
        return DirectReadings(submit) if self.mock is None else self.mock.readings(submit)

    def send(self, command: NodeCommand | Drive, /) -> None:
        """Ask a node for something, or tell the vehicle how to drive."""
        self.robot.handle(command, self._clock.now())
        self._pacer.touch()

    def set_fault(self, node: PartName, fault: Fault | None) -> None:
        """Let something be wrong with a node from now on; None: all is well again.

        Raises:
            UnknownPartError: There is no such node.
        """
        self.robot.nodes.set_fault(node, fault, self._clock.now())
        self._pacer.touch()

    def set_parameters(self, node: PartName, values: Parameters) -> None:
        """Change parameters of a node from outside, all or none.

        Raises:
            UnknownPartError: There is no such node.
            UnknownParameterError: It has no such parameter.
            InvalidValueError: A value is not of the parameter's type.
            RefusedError: The node does not run.
        """
        self.robot.nodes.set_parameters(node, values, self._clock.now())
        self._pacer.touch()

    def set_vehicle_reporting(self, reporting: bool) -> None:
        """Let the vehicle stop telling where it is, or tell it again."""
        self.robot.vehicle.set_reporting(reporting, self._clock.now())
        self._pacer.touch()
