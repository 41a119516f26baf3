"""What is published by a thread of its own, and requests that go out a few at a time."""

import asyncio
import threading
from collections.abc import Iterator

import pytest

from domain.errors import InvalidValueError
from service.ros.graph.graph import Fields
from service.ros.graph.sending import MAX_WAITING, Sender, Turnstile

PATIENCE_S = 5.0


@pytest.fixture
def sender() -> Iterator[Sender]:
    made = Sender()
    yield made
    made.stop()
    assert made.join(PATIENCE_S)


class Topic:
    """Where messages arrive, which may take its time."""

    def __init__(self) -> None:
        self.sent: list[int] = []
        self.threads: set[int] = set()
        self.entered = threading.Event()
        self.open = threading.Event()
        self.last = threading.Event()
        """Whether message -1 has been sent."""

    def send(self, message: Fields) -> None:
        self.entered.set()
        assert self.open.wait(PATIENCE_S)
        if message["data"] is None:
            raise InvalidValueError("/data must be a whole number")
        self.sent.append(message["data"])
        self.threads.add(threading.get_ident())
        if message["data"] == -1:
            self.last.set()


def test_messages_are_sent_in_their_order_by_another_thread(sender: Sender) -> None:
    topic = Topic()
    topic.open.set()
    for number in (1, 2, 3, -1):
        sender.send("/topic", topic.send, {"data": number})

    assert topic.last.wait(PATIENCE_S)
    assert topic.sent == [1, 2, 3, -1]
    assert threading.get_ident() not in topic.threads


def test_who_publishes_does_not_wait_for_the_network(sender: Sender) -> None:
    topic = Topic()

    sender.send("/topic", topic.send, {"data": -1})

    assert topic.sent == []
    topic.open.set()
    assert topic.last.wait(PATIENCE_S)


def test_a_message_that_its_type_cannot_hold_is_told_and_ends_nothing(
    sender: Sender, caplog: pytest.LogCaptureFixture
) -> None:
    topic = Topic()
    topic.open.set()

    sender.send("/topic", topic.send, {"data": None})
    sender.send("/topic", topic.send, {"data": -1})

    assert topic.last.wait(PATIENCE_S)
    assert topic.sent == [-1]
    assert "not published on /topic: /data must be a whole number" in caplog.text


def test_what_is_too_much_is_dropped_and_told_once(
    sender: Sender, caplog: pytest.LogCaptureFixture
) -> None:
    topic = Topic()
    sender.send("/topic", topic.send, {"data": 0})
    assert topic.entered.wait(PATIENCE_S)
    for number in range(1, MAX_WAITING):
        sender.send("/topic", topic.send, {"data": number})
    sender.send("/topic", topic.send, {"data": -1})
    for _ in range(10):
        sender.send("/topic", topic.send, {"data": 7})
    topic.open.set()

    assert topic.last.wait(PATIENCE_S)
    assert topic.sent == [*range(MAX_WAITING), -1]
    assert caplog.text.count("messages are dropped") == 1


def test_what_waits_when_it_stops_is_not_sent() -> None:
    sender, topic = Sender(), Topic()
    for number in range(MAX_WAITING + 1):
        sender.send("/topic", topic.send, {"data": number})

    sender.stop()
    topic.open.set()

    assert sender.join(PATIENCE_S)
    assert topic.sent in ([], [0])


async def test_many_requests_go_out_a_few_in_each_pass_of_the_loop_and_in_their_order() -> None:
    turnstile, passes, went = Turnstile(4), 0, list[tuple[int, int]]()

    async def go(number: int) -> None:
        await turnstile.wait_for_turn()
        went.append((passes, number))

    going = [asyncio.create_task(go(number)) for number in range(10)]
    while not all(task.done() for task in going):
        passes += 1
        await asyncio.sleep(0)

    assert [number for _, number in went] == list(range(10))
    per_pass = [sum(at == each for at, _ in went) for each in range(1, passes + 1)]
    assert [count for count in per_pass if count] == [4, 4, 2]


async def test_who_goes_while_waiting_leaves_the_turn_to_the_next() -> None:
    turnstile, went = Turnstile(1), list[int]()

    async def go(number: int) -> None:
        await turnstile.wait_for_turn()
        went.append(number)

    going = [asyncio.create_task(go(number)) for number in range(4)]
    await asyncio.sleep(0)
    going[1].cancel()
    await asyncio.wait(going, timeout=PATIENCE_S)

    assert went == [0, 2, 3]
