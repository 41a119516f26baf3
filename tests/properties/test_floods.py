"""Whatever clients send, a turn of the event loop has bounded work, and a stop is answered soon.

Streams of frames, heads and bodies are fed in pieces over many connections into the protocols and
the application behind them. What a turn does is counted and not timed.
"""

import asyncio
import gc
import os
import weakref
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import cast

import pytest
from hypothesis import Phase, Verbosity, given, settings
from hypothesis import strategies as st
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol
from websockets.frames import Frame

from api.app import prepare
from api.http.access import Access
from api.http.limits import ServiceLimits
from api.serving.frame_pieces import MAX_FRAMES
from api.serving.intake import READ_BYTES
from api.serving.pieces import HEAD_COST
from api.serving.turns import BUDGET, Turns
from domain.timebase import NANOSECONDS_PER_SECOND
from service.worker import WorkerBusyError
from tests.support.flooded_wire import Client, FloodedService
from tests.support.floods.counted_turns import CountedTurns
from tests.support.floods.streams import HOST, STREAMS, TOKEN, cut
from tests.support.http_robot import HttpRobot, http_robot

MAX_CALLS = 40_000
"""In one turn. The largest body that is checked, 1,000 readings of unknown signals, takes less than
30,000 and has its turn alone; four requests for 1,000 events each take 27,000."""
MAX_REQUESTS = BUDGET // HEAD_COST + 2
MAX_FRAMES_IN_A_TURN = 6 * MAX_FRAMES
"""As the cost of a frame allows."""
MAX_BYTES = 200_000
MAX_TURNS_OF_A_STOP = 20
MAX_TURNS_OF_AN_END = 20_000
"""Of all connections. What a rosbridge client has sent is heard to the end, in turn."""
TURNS = 40

STOP = (
    b"PUT /emergency_stop HTTP/1.1\r\n"
    + HOST
    + f"Authorization: Bearer {TOKEN}\r\n".encode()
    + b'Content-Length: 17\r\n\r\n{"engaged": true}'
)


class BusyJobs:
    """A worker that takes no job, in place of a process."""

    async def close(self) -> None:
        pass

    def require_room(self) -> None:
        pass

    async def call(self, *_: object) -> bytes:
        raise WorkerBusyError


@dataclass(frozen=True, repr=False)
class Stream:
    """What some clients send."""

    parts: list[bytes]
    """Each once the one before was answered."""
    sizes: list[int]
    """Of the pieces in which it arrives, bytes."""
    clients: int
    reads: bool
    """Whether they read their answers."""

    def __repr__(self) -> str:
        parts = [f"{part[:200]!r} ({len(part)} bytes)" for part in self.parts]
        return f"{self.clients} x {', '.join(parts)} by {self.sizes}, reads: {self.reads}"


class Sender:
    """One client that sends as fast as the service takes it."""

    def __init__(self, client: Client, stream: Stream) -> None:
        self.client = client
        self._reads = stream.reads
        self._parts = iter(stream.parts)
        self._sizes = stream.sizes
        self._pieces: Iterator[bytes] = iter(())
        self._awaited = -1

    def send(self) -> None:
        """Let the next piece arrive."""
        client = self.client
        if len(client.unread) < READ_BYTES:
            piece = next(self._pieces, b"")
            if not piece and len(client.raw.written) > self._awaited:
                self._pieces = cut(next(self._parts, b""), self._sizes)
                self._awaited = len(client.raw.written)
            client.unread += piece
        client.deliver()
        if not self._reads and not client.raw.is_closing() and not client.raw.unsent:
            client.raw.unsent = len(client.raw.written)
            if client.raw.unsent:
                client.intake.pause_writing()


class Flooded:
    """A robot with a token, whose connections and turns are counted."""

    def __init__(self, runner: asyncio.Runner) -> None:
        self.runner = runner
        self.loop = cast("CountedTurns", runner.get_loop())
        self._around = http_robot(
            access=Access.with_token(TOKEN),
            limits=ServiceLimits(requests_per_s=NANOSECONDS_PER_SECOND),
        )
        self.robot: HttpRobot = runner.run(self._around.__aenter__())
        runner.run(prepare(self.robot.app))
        self.robot.app.state.worker = self.robot.app.state.simulator = BusyJobs()

    def close(self) -> None:
        self.runner.run(self._around.__aexit__(None, None, None))

    async def flood(self, streams: list[Stream]) -> None:
        service = FloodedService(app=self.robot.app, turns=Turns.of(self.loop))
        gc.disable()
        try:
            traces = await self._flood(service, streams)
            for number in range(MAX_TURNS_OF_AN_END):
                await self._pass_turn(service)
                if number > TURNS and not service.state.tasks:
                    break
            assert not service.state.tasks
            assert not service.state.connections
            assert not len(service.connections)
            left = [trace for trace in traces if trace() is not None]
            assert not left, f"{len(left)} of {len(traces)} are kept"
        finally:
            gc.enable()

    async def _flood(
        self, service: FloodedService, streams: list[Stream]
    ) -> list[weakref.ref[object]]:
        senders = [
            Sender(service.connect(), stream) for stream in streams for _ in range(stream.clients)
        ]
        traces = [weakref.ref[object](each.client.intake) for each in senders]
        try:
            for _ in range(TURNS):
                await self._pass_turn(service, senders)
            await self._stop(service, senders)
            for _ in range(TURNS):
                await self._pass_turn(service, senders)
        finally:
            traces += [
                weakref.ref[object](each.client.intake.inner)
                for each in senders
                if hasattr(each.client.intake, "inner")
            ]
            for each in senders:
                each.client.lose()
        return traces

    async def _stop(self, service: FloodedService, senders: list[Sender]) -> None:
        owner = service.connect()
        owner.send(STOP)
        for _ in range(MAX_TURNS_OF_A_STOP):
            await self._pass_turn(service, senders)
            if owner.raw.written.startswith(b"HTTP/1.1 200"):
                break
        else:
            pytest.fail("the stop is not answered")
        owner.lose()

    async def _pass_turn(self, service: FloodedService, senders: Sequence[Sender] = ()) -> None:
        """Let a turn pass, and check what it did."""
        service.handed_on.clear()
        for sender in senders:
            sender.send()
        await asyncio.sleep(0)
        turn = self.loop.last
        assert turn.calls <= MAX_CALLS, turn.busiest(40)
        assert turn.of[HttpToolsProtocol.on_headers_complete.__code__] <= MAX_REQUESTS
        assert turn.of[Frame.parse.__code__] <= MAX_FRAMES_IN_A_TURN
        assert sum(service.handed_on) <= MAX_BYTES


@pytest.fixture(scope="module")
def flooded() -> Iterator[Flooded]:
    with asyncio.Runner(loop_factory=CountedTurns) as runner:
        flooded = Flooded(runner)
        yield flooded
        flooded.close()


_STREAMS = st.builds(
    Stream,
    STREAMS,
    st.sampled_from([[READ_BYTES], [1, READ_BYTES], [3, 7, READ_BYTES], [500], [14, 1_500]]),
    st.integers(1, 8),
    st.booleans(),
)


# Not shrunk, which takes minutes here, and not printed in full, which takes megabytes: the message
# says what the turn was busy with, and the note how each stream begins.
@pytest.mark.timeout(300)
@pytest.mark.filterwarnings("ignore:Generating overly large repr")
@settings(
    max_examples=60 if os.environ.get("PILOTHOUSE_SOAK") != "1" else 5_000,
    phases=(Phase.explicit, Phase.generate),
    verbosity=Verbosity.quiet,
)
@given(st.lists(_STREAMS, min_size=1, max_size=6))
def test_whatever_is_sent_a_turn_is_bounded_and_a_stop_is_answered(
    flooded: Flooded, streams: list[Stream]
) -> None:
    try:
        flooded.runner.run(flooded.flood(streams))
    except AssertionError as error:
        error.add_note("\n".join(map(repr, streams)))
        raise
