"""Many clients of one robot, in virtual time, each with a transport that a test can clog."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import ExitStack
from itertools import pairwise

import pytest

from api.streaming import stream_client
from api.streaming.client_input import TOPICS, StreamQuery
from api.streaming.encoder import StreamEncoder
from api.streaming.fan_out import FanOut
from api.streaming.websocket_frames import PING
from domain.actor import Actor
from domain.inputs import EmergencyStopRequest
from service.supervisor import Supervisor
from tests.support.kept_events import history_of
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock, settle
from tests.support.stream_wire import Wire

STATE = StreamQuery(frozenset({"system_state"}), None, None)
EVENTS = StreamQuery(frozenset({"events"}), 0, None)
ALL = StreamQuery(frozenset(TOPICS), None, None)


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def supervisor(clock: ManualClock) -> AsyncIterator[Supervisor]:
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        yield supervisor


@pytest.fixture
def fan_out(supervisor: Supervisor) -> FanOut:
    return FanOut(supervisor, StreamEncoder(supervisor), history_of(supervisor), supervisor.clock)


def press_and_release_the_stop(supervisor: Supervisor) -> None:
    for engaged in (True, False):
        supervisor.submit(EmergencyStopRequest(engaged, "test", Actor("operator")))


async def test_clients_in_step_are_written_the_very_same_bytes(
    fan_out: FanOut, clock: ManualClock
) -> None:
    first, second = Wire(), Wire()
    with (
        fan_out.serve(first.connection, STATE, "first"),
        fan_out.serve(second.connection, STATE, "second"),
    ):
        await clock.advance(1)

    assert len(first.written) == 21
    assert all(a is b for a, b in zip(first.written, second.written, strict=True))


async def test_events_and_the_frame_that_follows_are_one_write(
    fan_out: FanOut, supervisor: Supervisor
) -> None:
    wire = Wire()
    with fan_out.serve(wire.connection, ALL, "page"):
        await settle()
        wire.written.clear()
        supervisor.submit(EmergencyStopRequest(True, "test", Actor("operator")))
        await settle()

    assert len(wire.written) == 1
    assert wire.frames[0]["type"] == "event"
    assert wire.frames[-1]["system_state"]["state"] == "ERROR"


async def test_a_clogged_client_is_left_out_and_joins_again_without_a_hole(
    fan_out: FanOut, clock: ManualClock
) -> None:
    slow, quick = Wire(), Wire()
    with fan_out.serve(slow.connection, ALL, "slow"), fan_out.serve(quick.connection, ALL, "quick"):
        await clock.advance(0.2)
        slow.flows = False
        await clock.advance(1)
        slow.flow()
        await clock.advance(0.2)

    assert fan_out.skipped == 19
    assert not any(frame.get("skipped") for frame in quick.frames)
    states = [frame for frame in slow.frames if frame["type"] == "state"]
    (late,) = [frame for frame in states if frame["skipped"]]
    assert (late["skipped"], len(late["parts"])) == (19, 3)
    assert states[-1]["seq"] == quick.frames[-1]["seq"]
    assert slow.written[-1] is quick.written[-1]


async def test_a_clogged_client_misses_no_event(
    fan_out: FanOut, supervisor: Supervisor, clock: ManualClock
) -> None:
    wire = Wire()
    with fan_out.serve(wire.connection, EVENTS, "log"):
        await clock.advance(0.1)
        wire.flows = False
        for _ in range(40):
            press_and_release_the_stop(supervisor)
            await settle()
        wire.flow()
        await clock.advance(0.1)

    ids = [frame["id"] for frame in wire.frames]
    assert ids == list(range(1, supervisor.events.newest + 1))
    assert len(ids) > 40


async def test_a_long_history_is_written_without_waiting_for_the_next_tick(
    fan_out: FanOut, supervisor: Supervisor
) -> None:
    for _ in range(300):
        press_and_release_the_stop(supervisor)
    wire = Wire()
    with fan_out.serve(wire.connection, EVENTS, "log"):
        await settle()

    assert [frame["id"] for frame in wire.frames] == list(range(1, supervisor.events.newest + 1))
    assert len(wire.written) > 1


async def test_a_long_history_leaves_others_their_turn(
    fan_out: FanOut, supervisor: Supervisor
) -> None:
    for _ in range(500):
        press_and_release_the_stop(supervisor)
    turns = 0
    wire = Wire()
    with fan_out.serve(wire.connection, EVENTS, "log"):
        while len(wire.written) < 4:
            await asyncio.sleep(0)
            turns += 1

    assert turns >= 4


async def test_a_client_that_takes_a_little_now_and_then_is_kept(
    fan_out: FanOut, clock: ManualClock
) -> None:
    wire = Wire()
    wire.flows = False
    with fan_out.serve(wire.connection, STATE, "slow"):
        await clock.advance(0.1)
        for _ in range(10):
            wire.waiting -= 1
            await clock.advance(1)

    assert fan_out.dropped == 0
    assert not wire.closing


async def test_a_client_that_takes_nothing_is_dropped_once(
    fan_out: FanOut, clock: ManualClock
) -> None:
    wire = Wire()
    wire.flows = False
    with fan_out.serve(wire.connection, STATE, "mute"):
        await clock.advance(4.4)
        assert not wire.closing
        await clock.advance(5.6)

    assert wire.closing
    assert fan_out.dropped == 1


async def test_a_client_that_does_not_read_is_dropped_though_its_system_takes_all(
    fan_out: FanOut, clock: ManualClock
) -> None:
    mute, other = Wire(), Wire()
    with (
        fan_out.serve(mute.connection, STATE, "mute"),
        fan_out.serve(other.connection, STATE, "other"),
    ):
        await clock.advance(10)
        mute.answers = False
        await clock.advance(2)
        assert not mute.closing
        written = len(mute.written)
        await clock.advance(3)

    assert (mute.closing, other.closing) == (True, False)
    assert len(mute.written) == written + 1, "nothing but the end grows old in its buffers"
    assert fan_out.dropped == 1
    assert len(other.frames) == 301


async def test_after_a_pause_of_the_service_nobody_is_slow_whose_answer_waits_for_it(
    fan_out: FanOut, clock: ManualClock
) -> None:
    wire = Wire()
    with fan_out.serve(wire.connection, STATE, "page") as client:
        await clock.advance(1.0)
        wire.answers = False
        await clock.advance(0.15)
        assert client.owes_answer
        clock.stall(2.0)
        await clock.advance(0.1)
        assert not client.is_slow


async def test_a_client_that_stopped_to_read_long_before_it_clogs_is_not_given_more_time(
    fan_out: FanOut, clock: ManualClock
) -> None:
    wire = Wire()
    with fan_out.serve(wire.connection, STATE, "mute"):
        await clock.advance(10)
        wire.answers = False
        await clock.advance(2)
        wire.flows = False
        await clock.advance(3)

    assert wire.closing
    assert fan_out.dropped == 1


async def test_a_slow_client_is_not_asked_for_an_answer_that_waits_behind_a_large_frame(
    fan_out: FanOut, clock: ManualClock
) -> None:
    wire = Wire()
    with fan_out.serve(wire.connection, STATE, "slow"):
        await clock.advance(2)
        wire.flows = False
        for _ in range(10):
            await clock.advance(1)
            wire.waiting -= 1
        assert not wire.closing
        wire.flow()
        await clock.advance(10)

    assert fan_out.dropped == 0


async def test_nothing_is_written_to_a_connection_that_is_lost(
    fan_out: FanOut, clock: ManualClock
) -> None:
    wire, other = Wire(), Wire()
    with (
        fan_out.serve(wire.connection, STATE, "gone"),
        fan_out.serve(other.connection, STATE, "other"),
    ):
        await clock.advance(0.5)
        wire.abort()
        await clock.advance(0.5)

    assert len(other.written) == 2 * len(wire.written) - 1


async def test_clients_come_and_go_while_others_are_written_to(
    fan_out: FanOut, clock: ManualClock
) -> None:
    stays = Wire()
    with fan_out.serve(stays.connection, STATE, "stays"):
        for _ in range(20):
            with ExitStack() as guests:
                for number in range(150):
                    guests.enter_context(fan_out.serve(Wire().connection, STATE, f"guest {number}"))
                await clock.advance(0.05)

    assert len(stays.written) == 21


async def test_whoever_is_alone_begins_with_everything(fan_out: FanOut, clock: ManualClock) -> None:
    for _ in range(2):
        wire = Wire()
        with fan_out.serve(wire.connection, ALL, "page"):
            await clock.advance(0.1)

        first = next(frame for frame in wire.frames if frame["type"] == "state")
        assert (first["skipped"], len(first["parts"])) == (0, 3)


async def test_when_the_fan_out_fails_nobody_is_left_with_a_silent_connection(
    fan_out: FanOut,
    supervisor: Supervisor,
    clock: ManualClock,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    first, second, later = Wire(), Wire(), Wire()
    with monkeypatch.context() as broken:
        broken.setattr(StreamEncoder, "frame", None)
        with (
            fan_out.serve(first.connection, STATE, "first"),
            fan_out.serve(second.connection, ALL, "second"),
        ):
            await clock.advance(0.1)

    assert (first.closing, second.closing) == (True, True)
    assert "the fan-out failed" in caplog.text
    with fan_out.serve(later.connection, STATE, "later"):
        await clock.advance(0.1)
    assert later.frames


async def test_an_idle_client_gets_a_complete_frame_every_30_seconds(
    fan_out: FanOut, clock: ManualClock
) -> None:
    wire = Wire()
    with fan_out.serve(wire.connection, ALL, "page"):
        await clock.advance(100)

    states = [frame for frame in wire.frames if frame["type"] == "state"]
    complete = [frame for frame in states if len(frame.get("parts", {})) == 3]
    assert len(complete) == 4
    assert [b["seq"] - a["seq"] for a, b in pairwise(states)] == [1] * (len(states) - 1)
    assert not any(frame["skipped"] for frame in states)


async def test_clients_that_came_together_get_their_complete_frames_one_after_the_other(
    fan_out: FanOut, clock: ManualClock
) -> None:
    wires = [Wire() for _ in range(40)]
    with ExitStack() as served:
        for wire in wires:
            served.enter_context(fan_out.serve(wire.connection, ALL, "page"))
        await clock.advance(40)

    at = [
        frame["seq"]
        for wire in wires
        for frame in wire.frames[10:]
        if len(frame.get("parts", {})) == 3
    ]
    assert len(at) == 40
    assert len(set(at)) == 40


async def test_a_slow_reader_skips_frames_is_told_and_stays(
    fan_out: FanOut, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its kernel takes all, its program reads 8 frames a second."""
    wire = Wire()
    wire.answers = False
    left = 0
    monkeypatch.setattr(stream_client, "unacknowledged_bytes", lambda _: left)
    with fan_out.serve(wire.connection, STATE, "slow"):
        sent = 0
        for _ in range(60 * 8):
            await clock.advance(0.125)
            written = sum(map(len, wire.written))
            left = max(0, left + written - sent - len(wire.written[0]))
            sent = written

    assert (fan_out.dropped, wire.closing) == (0, False)
    states = [frame for frame in wire.frames if frame["type"] == "state"]
    assert sum(frame["skipped"] for frame in states) == fan_out.skipped > 300
    assert states[-1]["seq"] == sum(frame["skipped"] + 1 for frame in states) + states[0]["seq"] - 1
    # What it reads next is never old.
    assert left < 10_000


async def test_a_slow_reader_whose_own_computer_takes_all_skips_frames_is_told_and_stays(
    fan_out: FanOut, clock: ManualClock
) -> None:
    """Its program reads 8 writes a second, and answers a ping when it comes to it."""
    wire = Wire()
    wire.answers = False
    read = late = 0
    with fan_out.serve(wire.connection, STATE, "slow") as client:
        for _ in range(90 * 8):
            await clock.advance(0.125)
            if read == len(wire.written):
                continue
            if wire.written[read].endswith(PING):
                client.answered()
            read += 1
            late = len(wire.written) - read

    assert (fan_out.dropped, wire.closing) == (0, False)
    states = [frame for frame in wire.frames if frame["type"] == "state"]
    assert sum(frame["skipped"] for frame in states) == fan_out.skipped > 300
    assert states[-1]["seq"] == sum(frame["skipped"] + 1 for frame in states) + states[0]["seq"] - 1
    assert late <= 1


async def test_whoever_reads_nothing_at_all_is_told_and_cut_though_its_kernel_holds_data(
    fan_out: FanOut, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    wire = Wire()
    wire.answers = False
    monkeypatch.setattr(stream_client, "unacknowledged_bytes", lambda _: 5_000)
    with fan_out.serve(wire.connection, STATE, "mute"):
        await clock.advance(10)

    assert wire.closing
    assert wire.written[-1].endswith(b"you do not read")


async def test_it_owes_nothing_once_all_is_written(fan_out: FanOut, clock: ManualClock) -> None:
    wire = Wire()
    assert fan_out.owing_since() is None
    with fan_out.serve(wire.connection, ALL, "page"):
        assert fan_out.owing_since() == clock.now()
        await clock.advance(0.1)

        assert fan_out.owing_since() is None


async def test_the_watchdog_learns_that_the_fan_out_hangs(
    fan_out: FanOut,
    supervisor: Supervisor,
    clock: ManualClock,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    supervisor.publisher.owing_since = fan_out.owing_since

    async def hang(*_: object) -> None:
        await asyncio.Event().wait()

    monkeypatch.setattr(StreamEncoder, "prepare", hang)
    with fan_out.serve(Wire().connection, ALL, "page"):
        await clock.advance(0.9)
        assert supervisor.hanging() is None
        await clock.advance(0.2)

        assert supervisor.hanging() == "the stream has written nothing for 1.10 s"

    assert supervisor.hanging() is None


async def test_the_watchdog_learns_that_the_fan_out_has_failed_and_that_it_writes_again(
    fan_out: FanOut,
    supervisor: Supervisor,
    clock: ManualClock,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    supervisor.publisher.owing_since = fan_out.owing_since
    with monkeypatch.context() as broken:
        broken.setattr(StreamEncoder, "frame", None)
        with fan_out.serve(Wire().connection, STATE, "page"):
            await clock.advance(2)

    assert supervisor.hanging() == "the stream has written nothing for 2.00 s"
    with fan_out.serve(Wire().connection, STATE, "page"):
        await clock.advance(0.1)
    assert supervisor.hanging() is None
