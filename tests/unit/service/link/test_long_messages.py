import threading
from collections.abc import Iterator

import pytest

from domain.computers import ComputerName
from service.link.long_messages import LONG_BYTES, LongMessages
from service.link.port import MAX_BYTES_PER_S, MAX_MESSAGE_BYTES

BASE, ARM = ComputerName("base"), ComputerName("arm")
LONG = b"a" * LONG_BYTES
PATIENCE_S = 10.0


class Blocking:
    """Messages that go out when a test lets them."""

    def __init__(self) -> None:
        self.sent: list[tuple[ComputerName, bytes]] = []
        self.may_go = threading.Semaphore(0)
        self.went = threading.Semaphore(0)
        self.messages = LongMessages(self._put)

    def let_go(self, count: int) -> None:
        self.may_go.release(count)
        for _ in range(count):
            assert self.went.acquire(timeout=PATIENCE_S)

    def _put(self, to: ComputerName, message: bytes) -> None:
        self.may_go.acquire(timeout=PATIENCE_S)
        self.sent.append((to, message))
        self.went.release()


@pytest.fixture
def blocking() -> Iterator[Blocking]:
    made = Blocking()
    yield made
    made.may_go.release(1_000)
    made.messages.end()


def test_a_long_message_concerns_the_thread_and_a_short_one_does_not(blocking: Blocking) -> None:
    assert blocking.messages.concern(BASE, LONG)
    assert not blocking.messages.concern(BASE, b"short")


def test_what_comes_behind_a_long_message_for_the_same_computer_waits_for_it(
    blocking: Blocking,
) -> None:
    assert blocking.messages.send(BASE, LONG)

    assert blocking.messages.concern(BASE, b"short")
    assert not blocking.messages.concern(ARM, b"short")


def test_messages_go_out_in_their_order(blocking: Blocking) -> None:
    messages = [(BASE, LONG), (ARM, LONG), (BASE, b"behind it")]
    for to, message in messages:
        blocking.messages.send(to, message)

    blocking.let_go(3)

    assert blocking.sent == messages


def test_what_waits_is_bounded(blocking: Blocking) -> None:
    fit = MAX_BYTES_PER_S // MAX_MESSAGE_BYTES
    longest = b"a" * MAX_MESSAGE_BYTES

    sent = [blocking.messages.send(BASE, longest) for _ in range(fit + 2)]

    assert sent == [True] * fit + [False, False]


def test_what_was_given_goes_out_before_the_end(blocking: Blocking) -> None:
    blocking.messages.send(BASE, LONG)
    blocking.messages.end()

    blocking.let_go(1)

    assert blocking.sent == [(BASE, LONG)]
