"""`pilothouse replay --page`: serves a recording to the monitor page, on this machine only."""

import asyncio
import socket
from collections.abc import Callable, Sequence
from contextlib import ExitStack

from api.distribution import installed_version
from api.replaying.player import Player
from api.replaying.recording import Recording
from api.replaying.replay_app import create_replay_app
from api.serving.output import Output
from api.serving.process_log import log_to
from api.serving.serving import new_event_loop
from api.serving.stop_signals import StopSignals
from api.serving.web_server import WebServer, listen, url_of, web_server
from service.clock import continuous_clock, to_datetime

HOST = "127.0.0.1"
_STDOUT, _STDERR = 1, 2


def serve_replay(recording: Recording, port: int, speed: float) -> None:
    """Serve a recording until a signal ends it.

    Args:
        recording: What is shown.
        port: 0: a free one.
        speed: How much faster than then.

    Raises:
        ListenError: The port is not available.
        PilothouseError: It cannot be replayed.
    """
    output, errors = Output(_STDOUT), Output(_STDERR)
    try:
        log_to(errors, "warning", None)
        with ExitStack() as stack:
            sockets = listen(HOST, port)
            for item in sockets:
                stack.callback(item.close)
            runner = stack.enter_context(asyncio.Runner(loop_factory=new_event_loop))
            runner.run(_run(recording, sockets, speed, output.write))
    finally:
        output.close()
        errors.close()


async def _run(
    recording: Recording,
    sockets: Sequence[socket.socket],
    speed: float,
    say: Callable[[str], None],
) -> None:
    clock = continuous_clock()
    player = Player(recording, installed_version(), clock, speed)
    greeting = _greeting(recording, url_of(sockets, HOST))
    server = web_server(create_replay_app(player, clock), lambda: say(greeting))

    def stop() -> None:
        server.should_exit = True

    StopSignals(stop).install()
    async with asyncio.TaskGroup() as tasks:
        playing = tasks.create_task(player.run(), name="player")
        await _serve(server, sockets)
        playing.cancel()


async def _serve(server: WebServer, sockets: Sequence[socket.socket]) -> None:
    await server.serve(list(sockets))


def _greeting(recording: Recording, url: str) -> str:
    begin, end = (f"{to_datetime(at):%Y-%m-%d %H:%M:%S}" for at in (recording.begin, recording.end))
    return (
        f"REPLAY of {recording.robot}, from {begin} to {end} UTC\n"
        f"  page  {url}/\n"
        "Nothing here reaches a robot. Ctrl-C ends it.\n"
    )
