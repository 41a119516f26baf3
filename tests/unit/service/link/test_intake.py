import asyncio
import threading

import pytest

from domain.computers import ComputerName
from service.link.intake import Intake
from service.link.port import (
    MAX_BEATS_PER_S,
    MAX_BYTES_PER_S,
    MAX_MESSAGE_BYTES,
    MAX_MESSAGES_PER_S,
)
from tests.support.manual_clock import settle

BASE, ARM = ComputerName("base"), ComputerName("arm")


class Opened:
    """An intake, what it delivered, and a time that a test sets."""

    def __init__(self) -> None:
        self.now_s = 100.0
        self.delivered: list[tuple[ComputerName, bytes]] = []
        self.intake = Intake([BASE, ARM], lambda: self.now_s)
        self.open()

    def open(self) -> None:
        self.intake.open(lambda sender, message: self.delivered.append((sender, message)))

    def take_in(
        self, sender: ComputerName, message: bytes, count: int = 1, *, may_be_lost: bool = False
    ) -> None:
        for _ in range(count):
            self.intake.take_in(sender, message, may_be_lost=may_be_lost)

    async def delivered_of(self, sender: ComputerName) -> list[bytes]:
        await settle()
        return [message for of, message in self.delivered if of == sender]


@pytest.fixture
async def opened() -> Opened:
    return Opened()


async def test_a_message_of_another_thread_is_delivered_on_the_loops_thread() -> None:
    intake = Intake([BASE], lambda: 0.0)
    threads: list[threading.Thread] = []
    intake.open(lambda *_: threads.append(threading.current_thread()))

    await asyncio.to_thread(intake.take_in, BASE, b"a", may_be_lost=False)
    await settle()

    assert threads == [threading.current_thread()]


async def test_a_few_messages_are_delivered_in_each_pass_of_the_loop(opened: Opened) -> None:
    opened.take_in(BASE, b"a", 100)
    passes = 0

    while len(opened.delivered) < 100:
        await asyncio.sleep(0)
        passes += 1

    assert passes >= 12


async def test_senders_take_turns_and_beats_come_first(opened: Opened) -> None:
    opened.take_in(BASE, b"1")
    opened.take_in(BASE, b"2")
    opened.take_in(BASE, b"beat", may_be_lost=True)
    opened.take_in(ARM, b"3")
    await settle()

    assert opened.delivered == [(BASE, b"beat"), (ARM, b"3"), (BASE, b"1"), (BASE, b"2")]


async def test_a_stranger_is_not_heard(opened: Opened) -> None:
    opened.take_in(ComputerName("stranger"), b"a", 3)
    await settle()

    assert opened.delivered == []
    assert opened.intake.counts().unknown == 3


async def test_a_message_that_is_too_long_is_dropped(opened: Opened) -> None:
    opened.take_in(BASE, b"a" * (MAX_MESSAGE_BYTES + 1))

    assert await opened.delivered_of(BASE) == []
    assert opened.intake.counts().received == {BASE: 1, ARM: 0}


async def test_of_messages_that_are_too_many_the_last_ones_are_dropped(opened: Opened) -> None:
    for number in range(MAX_MESSAGES_PER_S + 5):
        opened.take_in(BASE, b"%d" % number)
    opened.take_in(ARM, b"of the arm")

    first = [b"%d" % number for number in range(MAX_MESSAGES_PER_S)]
    assert await opened.delivered_of(BASE) == first
    assert await opened.delivered_of(ARM) == [b"of the arm"]
    assert opened.intake.counts().received == {BASE: 5, ARM: 0}


async def test_the_rate_is_one_of_each_sender_and_over_time(opened: Opened) -> None:
    opened.take_in(BASE, b"a", MAX_MESSAGES_PER_S)
    await settle()
    opened.now_s += 0.1
    opened.take_in(BASE, b"b", MAX_MESSAGES_PER_S)

    later = (await opened.delivered_of(BASE))[MAX_MESSAGES_PER_S:]
    assert len(later) == pytest.approx(MAX_MESSAGES_PER_S / 10, abs=1)


async def test_the_bytes_that_wait_are_bounded(opened: Opened) -> None:
    fit = MAX_BYTES_PER_S // MAX_MESSAGE_BYTES

    opened.take_in(BASE, b"a" * MAX_MESSAGE_BYTES, fit + 3)

    assert len(await opened.delivered_of(BASE)) == fit


async def test_what_waits_is_bounded_also_while_the_loop_is_busy(opened: Opened) -> None:
    for _ in range(10):
        opened.take_in(BASE, b"a", MAX_MESSAGES_PER_S)
        opened.now_s += 1.0

    assert len(await opened.delivered_of(BASE)) == MAX_MESSAGES_PER_S


async def test_of_beats_that_wait_the_newest_are_kept(opened: Opened) -> None:
    for number in range(40):
        opened.take_in(BASE, b"%d" % number, may_be_lost=True)

    assert await opened.delivered_of(BASE) == [b"%d" % number for number in range(24, 40)]


async def test_beats_have_an_allowance_of_their_own(opened: Opened) -> None:
    opened.take_in(BASE, b"message", 2 * MAX_MESSAGES_PER_S)
    opened.take_in(BASE, b"beat", may_be_lost=True)

    assert b"beat" in await opened.delivered_of(BASE)


async def test_beats_that_are_too_many_are_dropped(opened: Opened) -> None:
    for _ in range(10 * MAX_BEATS_PER_S):
        opened.take_in(BASE, b"beat", may_be_lost=True)
        await settle()

    assert len(await opened.delivered_of(BASE)) == MAX_BEATS_PER_S


async def test_what_waits_at_the_end_is_not_delivered(opened: Opened) -> None:
    opened.take_in(BASE, b"a", 20)
    await asyncio.sleep(0)
    opened.intake.close()
    opened.take_in(BASE, b"b")

    assert await opened.delivered_of(BASE) == []


async def test_it_can_be_opened_again(opened: Opened) -> None:
    opened.take_in(BASE, b"before")
    opened.intake.close()
    opened.open()
    opened.take_in(BASE, b"after")

    assert await opened.delivered_of(BASE) == [b"after"]


def test_a_message_that_comes_when_the_loop_is_closed_is_forgotten() -> None:
    intake = Intake([BASE], lambda: 0.0)

    async def open_it() -> None:
        intake.open(lambda *_: None)

    asyncio.run(open_it())
    intake.take_in(BASE, b"a", may_be_lost=False)
