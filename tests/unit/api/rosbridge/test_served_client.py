"""One client of rosbridge, from its first message to its end, in virtual time."""

import asyncio
import json
from collections.abc import AsyncIterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from itertools import pairwise
from typing import Any

import pytest

from api.rosbridge.bridge import Bridge
from api.rosbridge.send_queue import MAX_WAITING
from api.rosbridge.served_client import ServedClient
from api.rosbridge.session import MAX_CALLS
from domain.actor import Actor
from tests.support.frames import frame
from tests.support.manual_clock import ManualClock, settle
from tests.support.rosbridge import MODE_EVENT, SYSTEM_STATE, Pipe, SmallInterface, make_bridge
from tests.support.websocket import texts_of

CALLER = Actor(way="rosbridge", address="test")


class Robot:
    """An interface, and a client that a test moves through time."""

    def __init__(self, bridge: Bridge | None = None) -> None:
        """Begin; with a bridge, as a further client of it."""
        self.clock = ManualClock()
        self.interface = SmallInterface()
        self.pipe = Pipe()
        self._bridge = bridge or make_bridge(self.interface, self.clock)
        self._client = ServedClient(self._bridge, self.pipe.connection, "test")
        self._said: asyncio.Queue[Mapping[str, Any]] = asyncio.Queue()
        self._seq = 0

    def another(self) -> "Robot":
        """Return a further client of the same interface."""
        return Robot(self._bridge)

    def say(self, op: str, **members: object) -> None:
        text = json.dumps({"op": op, **members})
        self._said.put_nowait({"type": "websocket.receive", "text": text})

    def leave(self) -> None:
        self._said.put_nowait({"type": "websocket.disconnect", "code": 1000})

    def heard(self) -> list[dict[str, Any]]:
        texts = [json.loads(text) for data in self.pipe.written for text in texts_of(data)]
        self.pipe.written.clear()
        return texts

    async def tick(self, ticks: int = 1) -> None:
        """Let the robot publish some frames, 50 ms apart."""
        for _ in range(ticks):
            await self.clock.advance(0.05)
            self._seq += 1
            self._bridge.frames.publish(frame(self._seq))
            await settle()

    async def serve(self) -> None:
        await self._client.serve(self._said.get)

    @asynccontextmanager
    async def served(self) -> AsyncIterator[asyncio.Task[None]]:
        serving = asyncio.create_task(self.serve())
        try:
            yield serving
        finally:
            self.leave()
            await serving


@pytest.fixture
def robot() -> Robot:
    return Robot()


async def test_what_a_client_subscribed_to_is_written_at_once(robot: Robot) -> None:
    async with robot.served():
        robot.say("subscribe", topic="/actuation/mode_event")
        await settle()
        robot.interface.tell(MODE_EVENT, {"timestamp": 1})
        robot.interface.tell(MODE_EVENT, {"timestamp": 2})
        await settle()

        assert [message["msg"]["timestamp"] for message in robot.heard()] == [1, 2]


async def test_a_client_that_reads_slowly_gets_the_newest_state_and_every_event(
    robot: Robot,
) -> None:
    async with robot.served():
        robot.say("subscribe", topic="/actuation/mode_event")
        robot.say("subscribe", topic="/system_state")
        await settle()
        robot.pipe.waiting = 100
        for number in range(5):
            robot.interface.tell(SYSTEM_STATE, {"state": number})
            robot.interface.tell(MODE_EVENT, {"timestamp": number})
            await robot.tick()
        assert robot.heard() == []

        robot.pipe.waiting = 0
        await robot.tick()
        heard = robot.heard()

    events = [m["msg"]["timestamp"] for m in heard if m["topic"] == "/actuation/mode_event"]
    assert events == [0, 1, 2, 3, 4]
    assert [m["msg"] for m in heard if m["topic"] == "/system_state"] == [{"state": 4}]


async def test_a_throttled_client_gets_what_is_due_without_a_further_message(robot: Robot) -> None:
    async with robot.served():
        robot.say("subscribe", topic="/system_state", throttle_rate=200)
        await robot.tick()
        robot.interface.tell(SYSTEM_STATE, {"state": 1})
        await settle()
        robot.interface.tell(SYSTEM_STATE, {"state": 2})
        await robot.tick(3)
        assert [message["msg"] for message in robot.heard()] == [{"state": 1}]

        await robot.tick()

        assert [message["msg"] for message in robot.heard()] == [{"state": 2}]


async def test_many_answers_are_written_in_some_turns_and_none_is_lost(robot: Robot) -> None:
    async with robot.served():
        robot.say("subscribe", topic="/actuation/mode_event")
        await settle()
        for number in range(300):
            robot.interface.tell(MODE_EVENT, {"timestamp": number})
        await settle()

        assert len(robot.pipe.written) == 3
        assert [m["msg"]["timestamp"] for m in robot.heard()] == [*range(300)]


async def test_a_client_that_takes_nothing_is_cut_off_within_five_seconds(
    robot: Robot, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("INFO", "api.rosbridge.served_client")
    async with robot.served():
        robot.pipe.waiting = 100
        await robot.tick(91)
        assert not robot.pipe.aborted

        await robot.tick(2)

        assert robot.pipe.aborted
    assert "dropped client test: it does not read" in caplog.text


async def test_a_client_that_vanished_is_cut_off_although_nothing_waits(robot: Robot) -> None:
    async with robot.served():
        # The first ping, after 1 s, is not answered, as the pipe answers nothing.
        await robot.tick(90)
        assert not robot.pipe.aborted

        await robot.tick(2)

        assert robot.pipe.aborted


async def test_a_client_that_talks_is_not_taken_for_one_that_vanished(robot: Robot) -> None:
    """Its answers to pings wait behind what it says, and may do so for longer than it has."""
    async with robot.served():
        for _ in range(200):
            robot.say("publish", topic="/estop", msg={"enabled": False})
            await robot.tick()

        assert not robot.pipe.aborted


async def test_a_client_that_talks_and_takes_nothing_is_cut_off(robot: Robot) -> None:
    async with robot.served():
        robot.pipe.waiting = 100
        for _ in range(93):
            robot.say("publish", topic="/estop", msg={"enabled": False})
            await robot.tick()

        assert robot.pipe.aborted


async def test_a_client_that_lets_its_answers_pile_up_is_cut_off(robot: Robot) -> None:
    async with robot.served():
        robot.pipe.waiting = 100
        await settle()
        for _ in range(MAX_WAITING + 1):
            robot.say("no_such_op")
        await robot.tick()

        assert robot.pipe.aborted


async def test_a_client_that_goes_leaves_nothing_behind(robot: Robot) -> None:
    async with robot.served() as serving:
        robot.say("subscribe", topic="/system_state")
        robot.say("call_service", service="/actuation/change_mode", args=["FAST"])
        await settle()
        assert robot.interface.listens(SYSTEM_STATE) == 1

        robot.leave()
        await serving

        assert robot.interface.listens(SYSTEM_STATE) == 0
        assert robot.interface.asked == [
            ({"mode_name": "FAST"}, Actor(way="rosbridge", address="test"))
        ]


async def test_of_a_client_that_went_readings_are_taken_and_some_last_calls_made(
    robot: Robot,
) -> None:
    robot.interface.answer.set()
    for _ in range(MAX_CALLS + 1):
        robot.say("call_service", service="/actuation/change_mode", args=["FAST"])
    robot.say("publish", topic="/estop", msg={"enabled": True})
    robot.leave()
    robot.pipe.abort()

    await robot.serve()

    assert len(robot.interface.asked) == MAX_CALLS
    assert robot.interface.readings == [({"enabled": True}, CALLER)]


async def test_a_fault_of_ours_ends_the_connection_and_is_not_hidden(robot: Robot) -> None:
    robot.interface.is_broken = True
    robot.say("call_service", service="/actuation/get_mode")

    with pytest.raises(ExceptionGroup) as failed:
        await robot.serve()

    assert failed.group_contains(ZeroDivisionError)


async def test_a_flood_of_messages_does_not_keep_others_from_their_turn(robot: Robot) -> None:
    done = robot.interface.readings
    seen = [0]
    async with robot.served():
        for _ in range(100):
            robot.say("publish", topic="/estop", msg={"enabled": False})
        for _ in range(1_000):
            await asyncio.sleep(0)
            seen.append(len(done))

    assert seen[-1] == 100
    assert max(after - before for before, after in pairwise(seen)) == 1


async def test_many_clients_together_do_not_keep_others_from_their_turn_either(
    robot: Robot,
) -> None:
    done = robot.interface.readings
    seen = [0]
    clients = [robot, *(robot.another() for _ in range(9))]
    async with AsyncExitStack() as served:
        for client in clients:
            await served.enter_async_context(client.served())
            for _ in range(10):
                client.say("publish", topic="/estop", msg={"enabled": False}, padding="x" * 1_000)
        for _ in range(300):
            await asyncio.sleep(0)
            seen.append(len(done))

    assert seen[-1] == 100
    assert max(after - before for before, after in pairwise(seen)) == 1


async def test_an_emergency_stop_waits_for_no_message_of_its_own_or_another_client(
    robot: Robot,
) -> None:
    flooding = [robot.another() for _ in range(9)]
    async with AsyncExitStack() as served:
        for client in (robot, *flooding):
            await served.enter_async_context(client.served())
            for _ in range(1_000):
                client.say("call_service", service="/nothing")
        await asyncio.sleep(0)
        robot.say("publish", topic="/estop", msg={"enabled": True})
        turns = 0
        while not robot.interface.readings:
            await asyncio.sleep(0)
            turns += 1

    assert turns <= 2


async def test_a_stop_is_taken_before_what_waits_and_no_earlier_release_ends_it(
    robot: Robot,
) -> None:
    async with robot.served():
        for number in range(20):
            robot.say("publish", topic="/estop", msg={"enabled": number % 3 == 0})
        await settle()

    taken = [fields["enabled"] for fields, _ in robot.interface.readings]
    # Those between the first and the last press were sent before a stop.
    assert taken == [True] * 7 + [False]
