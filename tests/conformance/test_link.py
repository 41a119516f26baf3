"""What every link between computers must keep.

An adapter joins with a class of its own in `UNDER_TEST`; the assertions are the same for all.
"""

import asyncio
import shutil
from collections.abc import AsyncIterator, Callable
from contextlib import AsyncExitStack
from functools import cache
from pathlib import Path
from typing import Protocol

import pytest

from domain.computers import SUPERVISOR, ComputerName
from service.link.endpoints import Endpoints
from service.link.memory import MemoryNetwork
from service.link.port import (
    MAX_BEATS_PER_S,
    MAX_MESSAGE_BYTES,
    MAX_MESSAGES_PER_S,
    Link,
)
from service.link.zenoh_link import ZenohLink
from tests.support.certificates import certificates_in, make_certificates
from tests.support.container import free_port
from tests.support.links import RunningLink
from tests.support.manual_clock import ManualClock

BASE, ARM = ComputerName("base"), ComputerName("arm")
STRANGER = ComputerName("stranger")
NAMES = (SUPERVISOR, BASE, ARM)
LAST = b"last"

both_kinds = pytest.mark.parametrize("may_be_lost", [False, True], ids=["messages", "beats"])


class Network(Protocol):
    """What connects the computers."""

    def __init__(self, certificates: Callable[[], Path]) -> None:
        """Prepare; `certificates` makes them, and returns their folder."""

    def link(self, name: ComputerName) -> Link:
        """Return a link of a computer."""


class InMemory:
    """Computers in virtual time."""

    def __init__(self, _: Callable[[], Path]) -> None:
        self._network = MemoryNetwork(NAMES, ManualClock())

    def link(self, name: ComputerName) -> Link:
        return self._network.link(name)


class OverTcp:
    """Computers over zenoh, in plain text."""

    protocol = "tcp"

    def __init__(self, certificates: Callable[[], Path]) -> None:
        self._at = f"{self.protocol}/127.0.0.1:{free_port()}"
        self._folder = None if self.protocol == "tcp" else certificates()

    def link(self, name: ComputerName) -> Link:
        own = self._at if name == SUPERVISOR else f"{self.protocol}/127.0.0.1:0"
        endpoints = Endpoints((own,), () if name == SUPERVISOR else (self._at,))
        files = None if self._folder is None else certificates_in(self._folder, name)
        return ZenohLink(name, [other for other in NAMES if other != name], endpoints, files)


class OverTls(OverTcp):
    """The same with certificates."""

    protocol = "tls"


class OverQuic(OverTcp):
    """The same with certificates, and with datagrams for what may be lost."""

    protocol = "quic"


UNDER_TEST: list[type[Network]] = [InMemory, OverTcp, OverTls, OverQuic]


class Robot:
    """The computers of a robot, of which each runs from when it was started."""

    def __init__(self, network: Network, running: AsyncExitStack) -> None:
        self.network = network
        self._running = running

    async def start(self, name: ComputerName) -> RunningLink:
        """Start a computer; also a second one of a name."""
        return await self._running.enter_async_context(RunningLink(name, self.network.link(name)))

    async def start_two(self) -> tuple[RunningLink, RunningLink]:
        """Start the supervisor and the base, which hear each other."""
        supervisor, base = await self.start(SUPERVISOR), await self.start(BASE)
        await base.reach(supervisor)
        await supervisor.reach(base)
        return supervisor, base


@pytest.fixture(scope="session")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Callable[[], Path]:
    """Return what makes certificates of all computers, where they are needed."""

    @cache
    def make() -> Path:
        if shutil.which("openssl") is None:
            pytest.skip("openssl is not installed")
        return make_certificates(tmp_path_factory.mktemp("certificates"), *NAMES)

    return make


@pytest.fixture(params=UNDER_TEST)
async def robot(
    request: pytest.FixtureRequest, certificates: Callable[[], Path]
) -> AsyncIterator[Robot]:
    async with AsyncExitStack() as running:
        yield Robot(request.param(certificates), running)


@pytest.fixture(autouse=True)
async def complaints() -> AsyncIterator[list[str]]:
    """Collect what is raised on the loop where nobody waits for it; by default, nothing is."""
    found: list[str] = []
    loop = asyncio.get_running_loop()
    loop.set_exception_handler(lambda _, context: found.append(str(context.get("exception"))))
    yield found
    loop.set_exception_handler(None)
    assert found == []


@both_kinds
async def test_messages_arrive_in_their_order_and_with_their_sender(
    robot: Robot, may_be_lost: bool
) -> None:
    supervisor, base = await robot.start_two()

    for number in range(10):
        base.send(SUPERVISOR, b"%d" % number, may_be_lost=may_be_lost)

    assert await supervisor.hear(10) == [(BASE, b"%d" % number) for number in range(10)]


async def test_a_message_is_for_one_computer_only(robot: Robot) -> None:
    supervisor, base = await robot.start_two()
    arm = await robot.start(ARM)
    await arm.reach(base)
    await supervisor.reach(arm)

    supervisor.send(BASE, b"for the base")
    supervisor.send(ARM, LAST)

    assert await base.hear(1) == [(SUPERVISOR, b"for the base")]
    assert await arm.hear(1) == [(SUPERVISOR, LAST)]


async def test_devices_hear_each_other_without_the_supervisor(robot: Robot) -> None:
    supervisor, base = await robot.start_two()
    arm = await robot.start(ARM)
    await arm.reach(base)
    await supervisor.stop()

    arm.send(BASE, b"stop", may_be_lost=True)

    assert await base.hear(1) == [(ARM, b"stop")]


async def test_any_bytes_arrive_as_they_are(robot: Robot) -> None:
    supervisor, base = await robot.start_two()

    base.send(SUPERVISOR, bytes(range(256)))
    base.send(SUPERVISOR, b"")

    assert await supervisor.hear(2) == [(BASE, bytes(range(256))), (BASE, b"")]


async def test_a_message_may_be_as_long_as_the_bound_and_not_longer(robot: Robot) -> None:
    supervisor, base = await robot.start_two()

    base.send(SUPERVISOR, b"a" * (MAX_MESSAGE_BYTES + 1))
    base.send(SUPERVISOR, b"b" * MAX_MESSAGE_BYTES)

    assert await supervisor.hear(1) == [(BASE, b"b" * MAX_MESSAGE_BYTES)]
    assert base.counts.sent == 1


@pytest.mark.parametrize("to", [STRANGER, BASE])
async def test_what_is_for_no_other_computer_of_the_robot_is_counted_and_dropped(
    robot: Robot, to: ComputerName
) -> None:
    supervisor, base = await robot.start_two()

    base.send(to, b"who is there?")
    base.send(SUPERVISOR, LAST)

    assert await supervisor.hear(1) == [(BASE, LAST)]
    assert base.received == []
    assert base.counts.sent == 1


@both_kinds
async def test_what_is_sent_to_a_computer_that_is_not_there_is_lost_and_nothing_is_raised(
    robot: Robot, may_be_lost: bool
) -> None:
    supervisor = await robot.start(SUPERVISOR)

    supervisor.send(BASE, b"too early", may_be_lost=may_be_lost)
    base = await robot.start(BASE)
    await supervisor.reach(base)
    supervisor.send(BASE, LAST, may_be_lost=may_be_lost)

    assert await base.hear_last(LAST) in ([], [b"too early"])


@pytest.mark.parametrize("who", [SUPERVISOR, BASE])
async def test_a_computer_that_comes_back_is_heard_and_hears(
    robot: Robot, who: ComputerName
) -> None:
    first, other = await robot.start_two()
    if who == BASE:
        first, other = other, first
    await first.stop()
    other.send(who, b"while it was away")

    again = await robot.start(who)
    await other.reach(again)
    await again.reach(other)
    other.send(who, LAST)
    again.send(other.name, LAST)

    assert await again.hear_last(LAST) in ([], [b"while it was away"])
    assert await other.hear(1) == [(who, LAST)]


async def test_two_computers_of_one_name_are_both_heard_and_both_hear(robot: Robot) -> None:
    supervisor, base = await robot.start_two()
    newcomer = await robot.start(BASE)
    await newcomer.reach(supervisor)
    await supervisor.reach(newcomer)

    base.send(SUPERVISOR, b"incumbent")
    newcomer.send(SUPERVISOR, b"newcomer")
    supervisor.send(BASE, b"for both")

    assert sorted(await supervisor.hear(2)) == [(BASE, b"incumbent"), (BASE, b"newcomer")]
    assert await base.hear(1) == [(SUPERVISOR, b"for both")]
    assert await newcomer.hear(1) == [(SUPERVISOR, b"for both")]


async def test_a_link_that_does_not_run_sends_nothing_and_raises_nothing(robot: Robot) -> None:
    supervisor, base = await robot.start_two()
    idle = robot.network.link(ARM)

    idle.send(SUPERVISOR, b"nobody runs me", may_be_lost=False)
    base.send(SUPERVISOR, LAST)

    assert await supervisor.hear(1) == [(BASE, LAST)]


async def test_a_link_that_was_cancelled_delivers_nothing_and_raises_nothing(
    robot: Robot,
) -> None:
    supervisor, base = await robot.start_two()
    arm = await robot.start(ARM)
    await arm.reach(base)
    base.send(SUPERVISOR, b"on its way")
    async with asyncio.timeout(5.0):
        await supervisor.stop()
    delivered = len(supervisor.received)

    base.send(SUPERVISOR, b"too late")
    supervisor.send(BASE, b"not any more")
    await arm.reach(base)

    assert supervisor.task.cancelled()
    assert len(supervisor.received) == delivered
    assert base.received == []


async def test_a_message_may_be_answered_while_it_is_delivered(robot: Robot) -> None:
    supervisor, base = await robot.start_two()

    def answer(sender: ComputerName, message: bytes) -> None:
        supervisor.send(sender, b"answer to " + message)

    supervisor.when_heard = answer
    base.send(SUPERVISOR, b"a question")

    assert await base.hear(1) == [(SUPERVISOR, b"answer to a question")]


async def test_a_message_that_cannot_be_dealt_with_loses_no_other(
    robot: Robot, complaints: list[str]
) -> None:
    supervisor, base = await robot.start_two()

    def refuse(_: ComputerName, message: bytes) -> None:
        if message == b"bad":
            raise ValueError("no such message")

    supervisor.when_heard = refuse
    for message in (b"before", b"bad", b"after"):
        base.send(SUPERVISOR, message)

    assert [message for _, message in await supervisor.hear(3)] == [b"before", b"bad", b"after"]
    assert complaints == ["no such message"]
    complaints.clear()


async def test_a_flood_is_bounded_and_hides_no_beat_and_no_other_computer(robot: Robot) -> None:
    supervisor, base = await robot.start_two()
    arm = await robot.start(ARM)
    await arm.reach(supervisor)
    loop = asyncio.get_running_loop()
    began, count = loop.time(), 3 * MAX_MESSAGES_PER_S

    for number in range(count):
        base.send(SUPERVISOR, b"%d" % number)
    base.send(SUPERVISOR, b"beat of the base", may_be_lost=True)
    arm.send(SUPERVISOR, b"of the arm")
    await supervisor.hear_last(b"beat of the base")
    await supervisor.hear_last(b"of the arm")

    flood = [message for sender, message in supervisor.received if sender == BASE]
    took_s = loop.time() - began
    assert len(flood) - 1 <= MAX_MESSAGES_PER_S * (1.0 + took_s)
    assert supervisor.counts.received[ARM] == 0


async def test_a_flood_of_beats_is_bounded(robot: Robot) -> None:
    supervisor, base = await robot.start_two()
    loop = asyncio.get_running_loop()
    began = loop.time()

    for number in range(10 * MAX_BEATS_PER_S):
        base.send(SUPERVISOR, b"%d" % number, may_be_lost=True)
    base.send(SUPERVISOR, LAST)
    heard = await supervisor.hear_last(LAST)

    assert 0 < len(heard) <= MAX_BEATS_PER_S * (1.0 + loop.time() - began)
