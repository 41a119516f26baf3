import pytest

from api.rosbridge.wire import Wire
from api.streaming.websocket_frames import PING
from tests.support.manual_clock import ManualClock
from tests.support.rosbridge import Pipe
from tests.support.websocket import texts_of


@pytest.fixture
def pipe() -> Pipe:
    return Pipe()


@pytest.fixture
def wire(pipe: Pipe, clock: ManualClock) -> Wire:
    return Wire(pipe.connection, clock)


def test_texts_are_written_at_once_each_as_a_frame(wire: Wire, pipe: Pipe) -> None:
    wire.write(["one", "two"])

    assert len(pipe.written) == 1
    assert [*texts_of(pipe.written[0])] == ["one", "two"]


def test_a_wire_on_which_something_waits_is_not_free(wire: Wire, pipe: Pipe) -> None:
    assert wire.is_free()
    pipe.waiting = 1
    assert not wire.is_free()


def test_a_wire_that_is_cut_off_is_not_free(wire: Wire, pipe: Pipe) -> None:
    wire.cut_off()

    assert pipe.aborted
    assert not wire.is_free()


async def test_a_client_is_asked_for_a_sign_of_life_every_second(
    wire: Wire, pipe: Pipe, clock: ManualClock
) -> None:
    for _ in range(100):
        await clock.advance(0.1)
        wire.ping()
        wire.answered()

    assert pipe.written == [PING] * 10
    assert not wire.is_silent()


async def test_a_client_that_does_not_answer_is_silent_four_and_a_half_seconds_after_it_came(
    wire: Wire, clock: ManualClock
) -> None:
    await clock.advance(1)
    wire.ping()

    await clock.advance(3.5)
    assert not wire.is_silent()
    await clock.advance(0.1)
    assert wire.is_silent()


async def test_a_client_that_takes_nothing_of_what_waits_is_silent_too(
    wire: Wire, pipe: Pipe, clock: ManualClock
) -> None:
    pipe.waiting = 10
    wire.is_free()

    await clock.advance(4.5)
    assert not wire.is_silent()
    await clock.advance(0.1)

    assert not wire.is_free()
    assert wire.is_silent()


async def test_a_client_that_takes_slowly_is_not(
    wire: Wire, pipe: Pipe, clock: ManualClock
) -> None:
    for waiting in (10, 8, 6, 4, 2):
        pipe.waiting = waiting
        wire.is_free()
        await clock.advance(2)

    assert not wire.is_silent()


async def test_a_client_of_whom_nothing_was_asked_owes_nothing(
    wire: Wire, clock: ManualClock
) -> None:
    await clock.advance(3_600)

    assert not wire.is_silent()


def test_what_the_connection_tells_else_is_looked_at_when_it_matters(
    wire: Wire, pipe: Pipe
) -> None:
    wire.clogged()
    wire.lost()

    assert wire.is_free()
    assert pipe.written == []
