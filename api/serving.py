"""`pilothouse serve`: put the parts together, then run robot and web server as equals.

The only place that names concrete adapters, and the owner of SIGINT, SIGTERM and every task.
"""

import asyncio
import gc
import logging
import os
import signal
import socket
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

from api.access import (
    FILE_VARIABLE,
    MIN_GOOD_CHARACTERS,
    TOKEN_VARIABLE,
    Access,
    InvalidTokenError,
    take_token,
)
from api.app import create_app, prepare
from api.distribution import installed_version
from api.limits import ServiceLimits
from api.metrics import metrics
from api.model_check import finding_line
from api.service_manager import ServiceManager, UnknownManagerError
from api.web_server import ListenError, WebServer, is_loopback, listen, url_of, web_server
from domain.errors import InvalidModelError
from domain.findings import Finding
from domain.system_model import SmhModel
from service.backends.simulated import SimulatedBackend
from service.clock import Clock, MonotonicClock
from service.files.model_file import load_model
from service.files.robot_file import InvalidRobotFileError, RobotSettings, load_robot_file
from service.files.text_file import UnreadableFileError
from service.robot_parts import make_onboard, make_simulated_robot
from service.start_task import StartTaskError, serve_start_task
from service.supervisor import Supervisor, TaskFailedError

log = logging.getLogger(__name__)

SUCCEEDED, FAILED, MISUSED, INTERRUPTED = 0, 1, 2, 130

EXAMPLE = Path(str(resources.files("service") / "example" / "actuation.yaml"))


@dataclass(frozen=True, slots=True)
class ServeOptions:
    """What `pilothouse serve` was told."""

    model: Path | None = None
    """None: the example."""
    robot: Path | None = None
    host: str = "127.0.0.1"
    port: int = 8000
    anonymous: bool = False
    mock_signals: bool = False
    allowed_hosts: tuple[str, ...] = ()
    log_level: str = "info"


class MisuseError(Exception):
    """The command was told what does not go together; the message says what to do."""


def serve(options: ServeOptions) -> int:
    """Run the service until a signal ends it, and return the exit code of the process."""
    _log_to_stderr(options.log_level)
    try:
        access = access_of(options, take_token())
        manager = ServiceManager.of(os.environ)
        supervisor = compose(options, MonotonicClock())
        limits = ServiceLimits.of(_robot_settings(options, supervisor.model).limits)
        sockets = listen(options.host, options.port)
    except (InvalidTokenError, MisuseError, UnknownManagerError) as error:
        return _complain(str(error), MISUSED)
    except InvalidModelError as error:
        return _complain_of(options.model or EXAMPLE, error.findings)
    except InvalidRobotFileError as error:
        return _complain_of(options.robot, error.findings)
    except (ListenError, StartTaskError, UnreadableFileError) as error:
        return _complain(str(error), FAILED)
    hosts = (options.host, *options.allowed_hosts)
    app = create_app(supervisor, allowed_hosts=hosts, access=access, limits=limits)
    app.state.exposed = options.anonymous and not is_loopback(options.host)
    prepare(app)
    metrics(app)
    greeting = "\n".join(greet(supervisor, options, url_of(sockets, options.host), access))
    server = web_server(app, lambda: _say_serving(greeting, manager, supervisor))
    # What was made until now stays: it need not be looked through again by each collection, which
    # would stop the tick for as long.
    gc.collect()
    gc.freeze()
    with asyncio.Runner(loop_factory=_new_event_loop) as runner:
        return runner.run(run_service(supervisor, server, sockets, manager))


def access_of(options: ServeOptions, token: str | None) -> Access:
    """Return whom the service lets in.

    Args:
        options: What the command was told.
        token: That of the environment; None: there is none.

    Raises:
        MisuseError: Others would reach the robot and nobody said who may, or it was said twice.
        ListenError: There is no such host.
    """
    if token is None:
        if not options.anonymous and not is_loopback(options.host):
            raise MisuseError(
                f"--host {options.host} lets others on the network control the robot: give the "
                f"service a token by {TOKEN_VARIABLE} or {FILE_VARIABLE}, say --anonymous if "
                "everybody may, or leave out --host"
            )
        return Access.open()
    if options.anonymous:
        raise MisuseError(
            f"--anonymous lets everybody in, and the token of {TOKEN_VARIABLE} or {FILE_VARIABLE} "
            "does not: leave out one of them"
        )
    if len(token) < MIN_GOOD_CHARACTERS:
        log.warning("the token is shorter than %d characters: guessable", MIN_GOOD_CHARACTERS)
    return Access.with_token(token)


def compose(options: ServeOptions, clock: Clock) -> Supervisor:
    """Return the supervisor of the robot that the options describe; nothing runs yet.

    Raises:
        UnreadableFileError: A file cannot be read.
        InvalidModelError: The model has faults.
        InvalidRobotFileError: The robot file has.
        StartTaskError: The task to begin with cannot be driven.
    """
    loaded = load_model(options.model or EXAMPLE)
    robot = _robot_settings(options, loaded.model)
    mock = _mocks(options, robot)
    now = clock.now()
    simulated = make_simulated_robot(loaded.model, robot, now, mock=mock)
    backend = SimulatedBackend(simulated, clock)
    supervisor = Supervisor(
        loaded,
        make_onboard(loaded.model, robot, now),
        clock,
        backend,
        backend.mock,
        simulated=simulated.what,
    )
    if options.robot is not None and robot.start_task is not None:
        serve_start_task(supervisor, robot.start_task, options.robot)
    return supervisor


async def run_service(
    supervisor: Supervisor,
    server: WebServer,
    sockets: Sequence[socket.socket],
    manager: ServiceManager,
) -> int:
    """Run robot and web server until a signal or a failure, and return the exit code.

    A supervisor that died takes the web server with it: a page that looks alive over a robot that
    nobody watches is the worst of ends. On a signal the vehicle is stopped, nodes are left as they
    are, and clients are told that the service goes (close code 1012). A second signal ends the
    process at once.
    """
    stopping = asyncio.Event()
    _on_signals(stopping)
    code = SUCCEEDED
    try:
        async with asyncio.TaskGroup() as tasks:
            supervising = tasks.create_task(supervisor.run(), name="supervisor")
            serving = tasks.create_task(_serve_until(stopping, server, sockets), name="web server")
            await stopping.wait()
            manager.say_stopping()
            # The robot first: the rest may take a moment.
            supervisor.stop_driving()
            supervisor.stop_waiting()
            server.should_exit = True
            await serving
            supervising.cancel()
    except* Exception as failures:
        for failure in _leaves(failures):
            log.critical("%s", failure, exc_info=failure.__cause__ or failure)
        code = FAILED
    return code


def greet(supervisor: Supervisor, options: ServeOptions, url: str, access: Access) -> Iterator[str]:
    """Say what runs, where, who may use it, and what to try first."""
    model = supervisor.model
    source = f"{options.model}" if options.model else "the built-in example"
    counts = f"{_count(len(model.systems), 'system')}, {_count(len(model.nodes), 'node')}"
    yield f"Pilothouse {installed_version()} supervises {source}: {counts}"
    yield f"  page  {url}/"
    if access.required:
        yield f"  token needed; the command line sends that in {TOKEN_VARIABLE}"
    curl = f'curl -H "Authorization: Bearer ${TOKEN_VARIABLE}"' if access.required else "curl"
    part = next(iter(model.parts), None)
    if part is not None:
        kind = "systems" if part in model.systems else "nodes"
        yield f"  try   {curl} {url}/{kind}/{part}"
        modes = model.modes_of(part)
        if modes:
            body = f'{{"mode": "{modes[-1]}"}}'
            yield f"        {curl} -X POST {url}/{kind}/{part}/mode -d '{body}'"
    if supervisor.simulated:
        yield f"Simulated: {', '.join(supervisor.simulated)}. Nothing here moves a real robot."
    for warning in supervisor.warnings:
        yield finding_line(source, warning)
    yield "Ctrl-C ends it; the vehicle is stopped, nodes are left as they are."


def _say_serving(greeting: str, manager: ServiceManager, supervisor: Supervisor) -> None:
    """Tell people that connections are accepted, and the service manager with the next tick."""
    print(greeting, flush=True)
    manager.watch(supervisor)


def _on_signals(stopping: asyncio.Event) -> None:
    def stop() -> None:
        if stopping.is_set():
            os._exit(INTERRUPTED)
        stopping.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, stop)


async def _serve_until(
    stopping: asyncio.Event, server: WebServer, sockets: Sequence[socket.socket]
) -> None:
    """Serve until told to stop; to end otherwise is a failure like that of any task."""
    await server.serve(list(sockets))
    if not stopping.is_set():
        raise TaskFailedError("web server")


def _leaves(group: BaseExceptionGroup[BaseException]) -> Iterator[BaseException]:
    for failure in group.exceptions:
        if isinstance(failure, BaseExceptionGroup):
            yield from _leaves(failure)
        else:
            yield failure


def _new_event_loop() -> asyncio.AbstractEventLoop:
    try:
        import uvloop
    except ImportError:  # There is none for Windows.
        return asyncio.new_event_loop()
    return uvloop.new_event_loop()


def _log_to_stderr(level: str) -> None:
    logging.basicConfig(
        level=level.upper(),
        stream=sys.stderr,
        format="%(asctime)s %(levelname)s %(name)s: %(message)s",
    )
    # It tells of each connection at this level; what matters is told by our own modules.
    for name in ("uvicorn.error", "uvicorn.access"):
        logging.getLogger(name).setLevel("DEBUG" if level == "debug" else "WARNING")


def _robot_settings(options: ServeOptions, model: SmhModel) -> RobotSettings:
    return load_robot_file(options.robot, model) if options.robot else RobotSettings()


def _mocks(options: ServeOptions, robot: RobotSettings) -> bool:
    """Tell whether the signals are mocked: with simulated nodes they are, unless told otherwise.

    So a model that somebody tries is IDLE, and not in ERROR for want of readings.
    """
    return options.mock_signals or robot.mock is not False


def _complain(message: str, code: int) -> int:
    print(f"pilothouse: {message}", file=sys.stderr)
    return code


def _complain_of(file: Path | None, findings: Sequence[Finding]) -> int:
    for finding in findings:
        print(finding_line(str(file), finding), file=sys.stderr)
    return FAILED


def _count(number: int, what: str) -> str:
    return f"{number} {what}" + ("" if number == 1 else "s")
