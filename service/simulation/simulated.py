"""The simulated robot in real time: a backend without a real robot."""

import asyncio
from collections import deque
from collections.abc import Mapping, Sequence
from functools import partial

from domain.commands import Drive, NodeCommand
from domain.inputs import BackendStatus, NodeAnswer, NodeReport, ReportBacklog
from domain.parameters import Parameters
from domain.simulation.node_settings import Fault
from domain.simulation.robot import RobotMessage, SimulatedRobot
from domain.simulation.vehicle_settings import VehicleFault
from domain.state_and_mode import PartName
from domain.timebase import Instant
from service.clock import Clock
from service.pacing import AT_ONCE, Pacer
from service.ports import Deliver
from service.readings import DirectReadings, ReadingInput, Submit
from service.simulation.mock_source import MockHandle

_SOURCE = "simulated nodes"


class SimulatedBackend:
    """Runs a `SimulatedRobot` on a clock: nodes, vehicle and, if it has them, mock signals.

    One adapter for all, since messages of the same instant have one order. Only of very many, those
    of the nodes come last, as with ROS 2.
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
        await self._pacer.run(deliver, partial(self._deliver_in_turns, deliver))

    async def _deliver_in_turns(
        self, deliver: Deliver, due: Sequence[RobotMessage], delivered: Instant
    ) -> None:
        """Deliver very many messages, some at a time, those of the nodes last.

        Other tasks must keep running, and a pose that comes behind the reports of thousands of
        nodes must not become too old meanwhile.
        """
        urgent = deque[RobotMessage]()
        others = deque[tuple[Instant, RobotMessage]]()
        """Each with up to when all that was due before it was handed over."""
        told, advanced = None, delivered
        while due or urgent or others:
            for message in due:
                if isinstance(message, NodeReport | NodeAnswer):
                    others.append((delivered, message))
                else:
                    urgent.append(message)
            if others and others[0][0] != told:
                told = others[0][0]
                deliver(ReportBacklog(_SOURCE, told))
            for _ in range(min(AT_ONCE, len(urgent) + len(others))):
                deliver(urgent.popleft() if urgent else others.popleft()[1])
            await asyncio.sleep(0)
            delivered, advanced = advanced, self._clock.now()
            due = self.robot.advance(advanced)
        deliver(ReportBacklog(_SOURCE, None))

    def readings(self, submit: Submit) -> ReadingInput:
        """Return the input for external readings."""
        return DirectReadings(submit) if self.mock is None else self.mock.readings(submit)

    def send(self, command: NodeCommand | Drive, /) -> None:
        """Send a command to a node or to the vehicle."""
        self.robot.handle(command, self._clock.now())
        self._pacer.touch()

    @property
    def node_faults(self) -> Mapping[PartName, str | None]:
        """Return all nodes with their faults; None: it has none."""
        return self.robot.nodes.faults()

    @property
    def vehicle_fault(self) -> str | None:
        """Return the fault of the vehicle; None: it has none."""
        return self.robot.vehicle.fault

    def set_fault(self, node: PartName, fault: str | None) -> None:
        """Inject a fault into a node; None: end it.

        Raises:
            UnknownPartError: There is no such node.
        """
        own = None if fault is None else Fault(fault)
        self.robot.nodes.set_fault(node, own, self._clock.now())
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

    def set_vehicle_fault(self, fault: str | None) -> None:
        """Inject a fault into the vehicle; None: end it."""
        own = None if fault is None else VehicleFault(fault)
        self.robot.vehicle.set_fault(own, self._clock.now())
        self._pacer.touch()
