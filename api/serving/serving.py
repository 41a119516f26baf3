"""`pilothouse serve`: runs supervisor and web server side by side.

Owns the handling of signals, and every task.
"""

import asyncio
import json
import logging
import os
import socket
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING

from api.access_token import FILE_VARIABLE, TOKEN_VARIABLE, InvalidTokenError, take_token
from api.app import create_app, prepare
from api.distribution import installed_version
from api.http.access import MIN_GOOD_CHARACTERS, Access
from api.http.gate.origins import AllowedOrigins, InvalidOriginError
from api.serving.composition import (
    Composition,
    RobotFiles,
    ServeOptions,
    compose,
    open_stores,
    read_files,
)
from api.serving.data_folder import MEMORY
from api.serving.failures import (
    FAILED,
    MISUSED,
    SUCCEEDED,
    complain_of,
    end_with,
    leaves,
    tell_failure,
)
from api.serving.garbage import Heap
from api.serving.misuse import MisuseError
from api.serving.output import Output
from api.serving.process_log import log_to
from api.serving.service_manager import ServiceManager, UnknownManagerError
from api.serving.standing import until_it_stands
from api.serving.stop_signals import StopSignals
from api.serving.web_server import ListenError, WebServer, is_loopback, listen, url_of, web_server
from api.terminal_text import counted, finding_line
from domain.errors import InvalidModelError
from service.clock import continuous_clock
from service.files.model_file import EXAMPLE
from service.files.robot_file import InvalidRobotFileError
from service.files.text_file import UnreadableFileError
from service.ros.graph.graph import UnknownFieldError, UnknownTypeError
from service.running import TaskFailedError
from service.start_task import StartTaskError
from service.storage.errors import FolderInUseError, UnusableFolderError
from service.supervisor import Supervisor

if TYPE_CHECKING:
    from service.ros.gateway import RosGateway

log = logging.getLogger(__name__)

_NOT_IN_ROS = (UnknownFieldError, UnknownTypeError)
_MISUSES = (
    InvalidOriginError,
    InvalidTokenError,
    MisuseError,
    UnknownManagerError,
    UnreadableFileError,
)
_STDOUT, _STDERR = 1, 2
_SWITCH_S = 0.0002
"""For how long a thread of storage waits for the interpreter's lock before it asks the loop for it.
While 50 clients set holds, half of all stops take 25 ms instead of 29 with 1 ms: the thread that
writes them down waits for it several times."""


def serve(options: ServeOptions) -> int:
    """Run the service until a signal ends it, and return the exit code of the process."""
    output, errors = Output(_STDOUT), Output(_STDERR)
    try:
        return _serve(options, output, errors)
    finally:
        output.close()
        logging.shutdown()
        errors.close()


def _serve(options: ServeOptions, output: Output, errors: Output) -> int:
    try:
        token = take_token()
        log_to(errors, options.log_level, token)
        access = access_of(options, token)
        origins = AllowedOrigins(options.allowed_origins)
        manager = ServiceManager.of(os.environ)
        files = read_files(options)
        sockets = listen(options.host, options.port)
        network = Network(access, origins, sockets)
        with ExitStack() as stack:
            for item in sockets:
                stack.callback(item.close)
            runner = stack.enter_context(asyncio.Runner(loop_factory=new_event_loop))
            return runner.run(_run(options, files, network, manager, output))
    except _MISUSES as error:
        return end_with(str(error), MISUSED)
    except InvalidModelError as error:
        return complain_of(options.model or EXAMPLE, error.findings)
    except InvalidRobotFileError as error:
        return complain_of(options.robot, error.findings)
    except FolderInUseError as error:
        return end_with(f"{error}; give this one another with --data", FAILED)
    except (ListenError, StartTaskError, UnusableFolderError, *_NOT_IN_ROS) as error:
        return end_with(str(error), FAILED)


@dataclass(frozen=True, slots=True)
class Network:
    """Who reaches the service, and where."""

    access: Access
    origins: AllowedOrigins
    sockets: Sequence[socket.socket]


async def _run(
    options: ServeOptions,
    files: RobotFiles,
    network: Network,
    manager: ServiceManager,
    output: Output,
) -> int:
    """Run the service on what earlier runs left, and return the exit code of the process."""
    # The threads of storage and the loop take the interpreter's lock from each other sooner.
    sys.setswitchinterval(_SWITCH_S)
    clock = continuous_clock()
    stores = await open_stores(options, files, clock)
    try:
        composition = compose(options, clock, files, stores)
        server = await _make_server(composition, options, network, manager, output)
        heap = Heap()
        heap.settle()
        composition.supervisor.publisher.on_tick.append(heap.note_tick)
        return await run_service(composition, server, network.sockets, manager)
    finally:
        await stores.close()


async def _make_server(
    composition: Composition,
    options: ServeOptions,
    network: Network,
    manager: ServiceManager,
    output: Output,
) -> WebServer:
    """Return the web server of the service; it greets once it accepts connections."""
    supervisor, hosts = composition.supervisor, (options.host, *options.allowed_hosts)
    app = create_app(
        supervisor,
        allowed_hosts=hosts,
        allowed_origins=network.origins,
        access=network.access,
        limits=composition.limits,
        simulated=composition.simulated,
        interface=composition.interface,
        worker=composition.worker,
    )
    app.state.exposed = options.anonymous and not is_loopback(options.host)
    await prepare(app)
    url = url_of(network.sockets, options.host)
    if options.form == "json":
        greeting = json.dumps(greeting_json(composition, options, url, network.access))
    else:
        greeting = "\n".join(greet(composition, options, url, network.access))
    return web_server(app, lambda: _say_serving(output, greeting, manager, supervisor))


def access_of(options: ServeOptions, token: str | None) -> Access:
    """Return the access control of the service.

    Args:
        options: Of the command.
        token: Of the environment; None: there is none.

    Raises:
        MisuseError: The network would have access without a token, with one that can be guessed,
            or without --anonymous; or both are given.
        ListenError: There is no such host.
    """
    if token is None:
        if not options.anonymous and not is_loopback(options.host):
            raise MisuseError(
                f"--host {options.host} lets others on the network control the robot: give the "
                f"service a token with {TOKEN_VARIABLE} or {FILE_VARIABLE}, use --anonymous if "
                "everybody may do so, or leave out --host"
            )
        return Access.open()
    if options.anonymous:
        raise MisuseError(
            f"--anonymous contradicts the token of {TOKEN_VARIABLE} or {FILE_VARIABLE}: leave out "
            "one of them"
        )
    if len(token) < MIN_GOOD_CHARACTERS:
        if not is_loopback(options.host):
            raise MisuseError(
                f"the token can be guessed: with --host {options.host} it needs at least "
                f"{MIN_GOOD_CHARACTERS} characters, as from: openssl rand -hex 32"
            )
        log.warning("the token can be guessed: it has less than %d characters", MIN_GOOD_CHARACTERS)
    return Access.with_token(token)


async def run_service(
    composition: Composition,
    server: WebServer,
    sockets: Sequence[socket.socket],
    manager: ServiceManager,
) -> int:
    """Run supervisor and web server until a signal or a failure, and return the exit code.

    If the supervisor fails, the web server ends too: a live page for a robot that is not supervised
    would be dangerous. The same holds for the gateway to ROS 2, if there is one. On a signal the
    vehicle is stopped, nodes stay as they are, and WebSockets are closed with code 1012; programs
    of nodes that run here are ended once the vehicle stands. A second signal ends the process at
    once.
    """
    supervisor, gateway = composition.supervisor, composition.gateway
    stopping = asyncio.Event()

    def stop() -> None:
        # Also if the vehicle cannot be told.
        stopping.set()
        # The robot first, and here: a second signal may end the process before a task runs.
        supervisor.stop_driving()

    StopSignals(stop).install()
    code = SUCCEEDED
    try:
        async with asyncio.TaskGroup() as tasks:
            supervising = tasks.create_task(supervisor.run(), name="supervisor")
            serving = tasks.create_task(_serve_until(stopping, server, sockets), name="web server")
            offering = tasks.create_task(_offer(gateway), name="gateway") if gateway else None
            await stopping.wait()
            manager.say_stopping()
            supervisor.change_ends.stop()
            server.should_exit = True
            await serving
            if offering is not None:
                offering.cancel()
            if supervisor.processes is not None:
                # Some of them may be what brakes it.
                await until_it_stands(supervisor)
            supervising.cancel()
    except* Exception as failures:
        for failure in leaves(failures):
            tell_failure(failure)
        code = FAILED
    return code


def greet(
    composition: Composition, options: ServeOptions, url: str, access: Access
) -> Iterator[str]:
    """Yield the lines that are printed at the start: robot, address, access, first commands."""
    supervisor = composition.supervisor
    model = supervisor.model
    source = f"{options.model}" if options.model else "the built-in example"
    counts = f"{counted(len(model.systems), 'system')}, {counted(len(model.nodes), 'node')}"
    does = "supervises" if options.device is None else f"is device {options.device} of"
    yield f"Pilothouse {installed_version()} {does} {source}: {counts}"
    yield f"  page  {url}/"
    yield f"  ros   {url.replace('http', 'ws', 1)}/rosbridge for clients of rosbridge"
    if composition.place is not None:
        yield f"  link  {composition.place.words}"
    if access.required:
        yield f"  token needed; the command line sends that in {TOKEN_VARIABLE}"
    curl = f'curl -H "Authorization: Bearer ${TOKEN_VARIABLE}"' if access.required else "curl"
    part = next(iter(model.parts), None)
    if part is not None:
        kind = "systems" if part in model.systems else "nodes"
        yield f"  try   {curl} {url}/{kind}/{part}"
        modes = model.modes_of(part)
        if modes and options.device is None:
            body = f'{{"mode": "{modes[-1]}"}}'
            yield f"        {curl} -X POST {url}/{kind}/{part}/mode -d '{body}'"
    if composition.gateway is not None:
        domain = os.environ.get("ROS_DOMAIN_ID") or "0"
        yield f"ROS 2: domain {domain}. Nodes are real: requests here change them."
    yield from _remembering(supervisor)
    if supervisor.simulated:
        harmless = "" if composition.gateway else " Nothing here moves a real robot."
        yield f"Simulated: {', '.join(supervisor.simulated)}.{harmless}"
    for warning in supervisor.warnings:
        yield finding_line(source, warning)
    vehicle = " and the vehicle" if options.device is None else ""
    others = "nodes stay as they are"
    if supervisor.processes is not None:
        others = "programs that it runs end with it, and other nodes stay as they are"
    yield f"Ctrl-C stops the service{vehicle}; {others}."


def greeting_json(
    composition: Composition, options: ServeOptions, url: str, access: Access
) -> dict[str, object]:
    """Return what a program needs that starts the service: first of all, where it listens."""
    journal = composition.supervisor.journal
    return {
        "url": url,
        "version": installed_version(),
        "model": None if options.model is None else str(options.model),
        "data": None if journal is None else journal.status().path,
        "token_needed": access.required,
        "simulated": list(composition.supervisor.simulated),
        "device": options.device,
        "link": None if composition.place is None else list(composition.place.endpoints.listen),
    }


def _remembering(supervisor: Supervisor) -> Iterator[str]:
    """Yield what the service remembers, where, and how to forget it."""
    journal = supervisor.journal
    if journal is None:
        return
    status, found = journal.status(), journal.found
    if status.path == MEMORY:
        yield "Nothing survives a restart (--data :memory:)."
        return
    yield f"Remembers in {status.path}; to forget: stop it and delete that folder."
    if found.restored.stop_because:
        yield f"THE EMERGENCY STOP IS ENGAGED: {found.restored.stop_because}"
    elif not found.is_new:
        at = "" if found.ended_at is None else f" of {found.ended_at:%Y-%m-%d %H:%M:%S} UTC"
        yield f"  goes on from run {found.restored.boot - 1}{at}: nothing moves before you ask"
    for left in found.left_out:
        yield f"  left out: {left}"


def _say_serving(
    output: Output, greeting: str, manager: ServiceManager, supervisor: Supervisor
) -> None:
    """Print that connections are accepted; the next tick notifies the service manager."""
    output.write(f"{greeting}\n")
    manager.watch(supervisor)


async def _serve_until(
    stopping: asyncio.Event, server: WebServer, sockets: Sequence[socket.socket]
) -> None:
    """Serve until `stopping` is set; ending without it is a failure, as for any task."""
    await server.serve(list(sockets))
    if not stopping.is_set():
        raise TaskFailedError("web server")


async def _offer(gateway: "RosGateway") -> None:
    """Offer the robot to ROS 2; ending is a failure, as for any task."""
    await gateway.offer()
    await gateway.run()
    raise TaskFailedError("gateway")


def new_event_loop() -> asyncio.AbstractEventLoop:
    """Return the loop that a server runs in: uvloop, where there is one."""
    try:
        import uvloop
    except ImportError:  # There is none for Windows.
        return asyncio.new_event_loop()
    return uvloop.new_event_loop()
