"""Composes the service of `pilothouse serve`: the only place that names concrete adapters."""

import logging
import os
import secrets
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeAlias

from api.app import make_worker
from api.distribution import installed_version
from api.http.limits import ServiceLimits
from api.serving.computers import make_link
from api.serving.data_folder import MEMORY, data_folder, robot_name
from api.serving.joining import join_graph
from api.serving.misuse import MisuseError
from api.simulation.simulation_job import SimulatedParts
from domain.errors import UnknownDeviceError
from domain.onboard import Onboard
from domain.simulation.mock_signals import MockSignals
from domain.state_and_mode import PartName
from domain.timebase import Instant
from service.clock import Clock
from service.composite import CompositeRobot
from service.files.computer_share import ComputerShare, share_of
from service.files.model_file import EXAMPLE, LoadedModel, load_model, with_signals
from service.files.robot_file import (
    RobotSettings,
    read_robot_file,
    written_for_device,
    written_out,
    written_with_backend,
)
from service.files.ros2_block import Ros2Block
from service.files.text_file import read_text_file
from service.files.waypoint_folder import WaypointFolder
from service.keeper import NO_STORES, Stores
from service.link.device_end import DeviceEnd
from service.link.place import Place, place_in
from service.link.supervisor_end import RemoteNodes, SupervisorEnd
from service.onboard_parts import make_onboard
from service.ports import NodeBackend, RobotBackend, SignalSource
from service.processes.from_settings import make_processes
from service.ros.graph.graph import RosGraph, UnknownTypeError
from service.ros.interface.interface import RosInterface
from service.ros.interface.message_sets import MessageSet
from service.ros.interface.settings import USUAL_SETTINGS, InterfaceSettings
from service.simulation.from_settings import make_simulated_robot
from service.simulation.mock_source import MockSource
from service.simulation.remembering import memories_of, memory_in
from service.simulation.simulated import SimulatedBackend
from service.source_status import SourceStatus
from service.sources.from_settings import make_sources
from service.start_task import submit_start_task
from service.storage.journal import Boot
from service.storage.memory import MemoryJournal
from service.storage.sqlite.journal import SqliteJournal
from service.storage.sqlite.opening import StoreSettings
from service.storage.trends.trends import Trends
from service.supervisor import Supervisor
from service.worker import Worker

if TYPE_CHECKING:
    from service.ros.backend.backend import Ros2Backend
    from service.ros.gateway import RosGateway

log = logging.getLogger(__name__)

BackendName: TypeAlias = Literal["simulated", "ros2"]


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
    form: Literal["text", "json"] = "text"
    """Of the greeting."""
    data: str = MEMORY
    """Folder for what survives a restart, or `MEMORY`, or `USUAL`."""
    device: str | None = None
    """Which device of the robot this is; None: its supervisor."""
    link: tuple[str, ...] = ()
    """Where this computer listens for the others; empty: as in the robot file."""
    insecure_link: bool = False
    """Whether the link may go over a network without certificates."""


@dataclass(frozen=True, slots=True)
class Composition:
    """The parts of a service, none of which runs yet."""

    supervisor: Supervisor
    limits: ServiceLimits
    gateway: "RosGateway | None" = None
    """Offers the robot to ROS 2; None: its nodes are simulated."""
    simulated: SimulatedParts | None = None
    """The simulated robot, which a simulation can copy; None: the robot is real, or only a part of
    it is here."""
    place: Place | None = None
    """Where this computer is among those of the robot; None: it is the only one."""
    interface: InterfaceSettings = USUAL_SETTINGS
    """What is offered to ROS, and to clients of rosbridge."""
    worker: Worker | None = None
    """Does jobs of the gateway, and may do others; None: there is no gateway."""


@dataclass(frozen=True, slots=True)
class RobotFiles:
    """What the files say of a robot."""

    name: str
    """Of the robot, and of the device if it is one: what survives a restart is kept under it."""
    loaded: LoadedModel
    """The model of the whole robot."""
    settings: RobotSettings
    """Of the whole robot; `device` says which computer this is."""
    text: str
    """Of the robot file, as the log keeps it; empty: there is none."""
    share: ComputerShare
    """What this computer runs of it."""

    @property
    def is_device(self) -> bool:
        """Tell whether this computer is a device, and not the supervisor."""
        return self.settings.device is not None

    @property
    def own_part(self) -> LoadedModel:
        """Return the part of the model that this computer runs."""
        if not self.is_device:
            return self.loaded
        return LoadedModel(self.share.model, (), self.loaded.text, self.loaded.name)


def read_files(options: ServeOptions) -> RobotFiles:
    """Read model and robot file.

    Raises:
        UnreadableFileError: A file cannot be read.
        InvalidModelError: The model is invalid.
        InvalidRobotFileError: The robot file is invalid.
        MisuseError: The robot file has no such device.
    """
    model = options.model or EXAMPLE
    loaded = load_model(model)
    text, settings = "", RobotSettings()
    if options.robot:
        text = read_text_file(options.robot)
        settings = read_robot_file(text, loaded.model)
        loaded = with_signals(loaded, settings.to_signal_settings())
        if options.backend not in (None, settings.backend):
            text = written_with_backend(text, options.backend)
        if options.device is None:
            text = written_out(text)
        else:
            settings = settings.model_copy(update={"device": options.device})
            text = written_for_device(text, options.device)
    if options.backend is not None:
        settings = settings.model_copy(update={"backend": options.backend})
    try:
        share = share_of(loaded.model, settings)
    except UnknownDeviceError as error:
        known = error.hint or "it has no block `devices`"
        raise MisuseError(f"{options.robot}: {error}; {known}") from error
    name = robot_name(settings.name, model)
    if settings.device is not None:
        name = f"{name}-{settings.device}"
    return RobotFiles(name, loaded, settings, text, share)


async def open_stores(options: ServeOptions, files: RobotFiles, clock: Clock) -> Stores:
    """Open what an earlier run of the service left of the robot.

    Raises:
        UnusableFolderError: The folder is in use, of another robot, or cannot be used at all.
    """
    now = clock.now()
    boot = Boot(
        secrets.token_hex(8),
        installed_version(),
        now,
        clock.wall_time(now),
        files.loaded.text,
        files.text,
    )
    folder = data_folder(options.data, files.name, os.environ)
    signals = files.settings.to_signal_settings()
    if folder is None:
        return Stores(MemoryJournal(boot, clock), Trends(signals))
    journal = await SqliteJournal.open(StoreSettings(folder, files.name), boot, clock)
    return Stores(journal, Trends(signals, str(folder / "trends.db")))


def compose(
    options: ServeOptions, clock: Clock, files: RobotFiles, stores: Stores = NO_STORES
) -> Composition:
    """Return the parts of a service for the robot that the options describe.

    Args:
        options: Of the command.
        clock: Of the service.
        files: What `read_files` returned for the options.
        stores: Keep what must survive a restart.

    Raises:
        StartTaskError: The start task cannot be driven.
        MisuseError: ROS 2 is required and not available.
        UnknownTypeError: The type of a topic in the robot file is not installed.
        UnknownFieldError: That type does not have the field that the robot file names.
    """
    is_real = files.settings.backend == "ros2"
    make = _with_ros2 if is_real else _with_simulated
    for left in files.share.left_out:
        log.warning("left to the supervisor: %s", left.words)
    composition = make(options, files, clock, stores)
    start_task = files.share.robot.start_task
    if options.robot is not None and start_task is not None:
        submit_start_task(composition.supervisor, start_task, options.robot)
    return composition


def _with_simulated(
    options: ServeOptions, files: RobotFiles, clock: Clock, stores: Stores
) -> Composition:
    """Simulate everything that this computer reaches, by default also the signals.

    So a model that is tried without a robot is IDLE, and not in ERROR because of missing readings.
    """
    share, robot = files.share, files.share.local_robot
    mocked = options.mock_signals or robot.mock is not False
    if robot.ros2.model_copy(update={"messages": Ros2Block().messages}) != Ros2Block():
        log.warning("`ros2` of the robot file has no effect: everything is simulated")
    if any(node.process is not None for node in robot.nodes.values()):
        log.warning("`process` of the robot file has no effect: the nodes are simulated")
    now = clock.now()
    memory = None if stores.journal is None else memory_in(stores.journal.found)
    simulated = make_simulated_robot(
        share.local_model, robot, now, mock=mocked and not files.is_device, memory=memory
    )
    for left in simulated.left_out:
        log.warning("left out: %s", left)
    _leave_to_others(share, simulated.mock)
    what = tuple(each for each in simulated.what if each != "nodes" or share.local_model.nodes)
    if files.is_device:
        what = ("nodes",)
        simulated.vehicle.set_reporting(False, now)
    backend = SimulatedBackend(simulated, clock)
    place, link = _link_of(options, files, clock)
    whole, status = _with_sources(files, clock, backend, (backend,), link)
    onboard = _onboard(files, stores, now)
    stores = replace(stores, memories=memories_of(simulated))
    supervisor = Supervisor(
        files.own_part, onboard, clock, whole, backend.readings, what, stores=stores
    )
    supervisor.sources, supervisor.link = status, link
    supervisor.live_faults = backend
    limits = ServiceLimits.of(robot.limits)
    parts = None if link else SimulatedParts(onboard, simulated)
    return Composition(
        supervisor, limits, simulated=parts, place=place, interface=_interface(options, robot)
    )


def _with_ros2(
    options: ServeOptions, files: RobotFiles, clock: Clock, stores: Stores
) -> Composition:
    """Reach real nodes; signals are mocked only on request."""
    # Imported here: they take 0.6 MB, and a simulated robot does without them.
    from service.ros.backend.backend import Ros2Backend
    from service.ros.gateway import RosGateway

    share, robot = files.share, files.share.local_robot
    mocked = options.mock_signals or robot.mock is True
    now = clock.now()
    graph = join_graph()
    _require_types(graph, robot.ros2)
    ros = Ros2Backend(share.local_model, robot, graph, clock)
    onboard = _onboard(files, stores, now)
    place, link = _link_of(options, files, clock)
    if mocked and not files.is_device:
        signals = MockSignals(now)
        _leave_to_others(share, signals)
        mock = MockSource(signals, clock)
        backend, status = _with_sources(files, clock, ros, (ros, mock), link)
        supervisor = Supervisor(
            files.own_part, onboard, clock, backend, mock.readings, ("signals",), stores=stores
        )
    else:
        backend, status = _with_sources(files, clock, ros, (ros,), link)
        supervisor = Supervisor(files.own_part, onboard, clock, backend, stores=stores)
    supervisor.sources, supervisor.link, supervisor.navigation = status, link, ros
    supervisor.processes = make_processes(robot, options.robot)
    mapped = {block.topic for block in robot.ros2.signals.values()}
    interface, worker = _interface(options, robot), make_worker()
    gateway = RosGateway(RosInterface(supervisor, interface, worker), graph, clock, mapped)
    limits = ServiceLimits.of(robot.limits)
    return Composition(supervisor, limits, gateway, place=place, interface=interface, worker=worker)


def _onboard(files: RobotFiles, stores: Stores, now: Instant) -> Onboard:
    """Return the core of a robot; it begins when its record does, from which it is made again."""
    start = now if stores.journal is None else stores.journal.boot.started_at
    return make_onboard(files.loaded.model, files.settings, start)


def _interface(options: ServeOptions, robot: RobotSettings) -> InterfaceSettings:
    """Return what a robot file says about the interface to ROS."""
    messages, frame_id = MessageSet(robot.ros2.messages), robot.vehicle.frame_id
    if options.robot is None or robot.tasks is None:
        return InterfaceSettings(messages, frame_id=frame_id)
    folder = options.robot.parent / robot.tasks.folder
    if not folder.is_dir():
        log.warning("tasks.folder: there is no folder %s; /serve_waypoints finds no file", folder)
    return InterfaceSettings(messages, WaypointFolder(folder), frame_id)


def _link_of(
    options: ServeOptions, files: RobotFiles, clock: Clock
) -> tuple[Place | None, SupervisorEnd | DeviceEnd | None]:
    """Return where this computer is among those of the robot, and its end of the link."""
    place = place_in(files.settings, options.link)
    if place is None:
        return None, None
    model, robot = files.loaded.model, files.settings
    return place, make_link(place, model, robot, clock, insecure=options.insecure_link)


def _with_sources(
    files: RobotFiles,
    clock: Clock,
    backend: "SimulatedBackend | Ros2Backend",
    signals: tuple[SignalSource, ...],
    link: SupervisorEnd | DeviceEnd | None,
) -> tuple[RobotBackend, tuple[SourceStatus, ...]]:
    """Return a backend with the sources of the robot file, and how those are doing."""
    share = files.share
    sources = make_sources(share.local_robot, clock)
    if sources is not None:
        signals = (*signals, sources)
    nodes: dict[PartName, NodeBackend] = dict.fromkeys(share.local_model.nodes, backend)
    if isinstance(link, SupervisorEnd):
        remote = RemoteNodes(link)
        nodes = dict.fromkeys(share.model.nodes, remote) | nodes
    vehicle = None if files.is_device else backend
    return CompositeRobot(nodes, vehicle, signals), () if sources is None else sources.status


def _leave_to_others(share: ComputerShare, mock: MockSignals | None) -> None:
    """Let the mock not publish the signals that have a source, here or at another computer."""
    if mock is not None:
        mock.leave_out((*share.local_robot.signals.sources, *share.read_elsewhere))


def _require_types(graph: RosGraph, topics: Ros2Block) -> None:
    """Check, before anything runs, the types and fields that the robot file names.

    Raises:
        UnknownTypeError: A type is not installed.
        UnknownFieldError: A type does not have the field for the value of a signal.
    """
    from service.ros.backend.diagnostics import TYPE as DIAGNOSTICS

    named = [signal.type for signal in topics.signals.values()]
    named += [statistic.type for statistic in topics.statistics.values()]
    if topics.command is not None:
        named.append(topics.command.type)
    if topics.diagnostics is not None:
        named.append(DIAGNOSTICS)
    if topics.navigation is not None:
        named.append(topics.navigation.type)
    for type_name in named:
        if not graph.has_type(type_name):
            raise UnknownTypeError(type_name)
    for signal in topics.signals.values():
        graph.require_field(signal.type, signal.path or ())
