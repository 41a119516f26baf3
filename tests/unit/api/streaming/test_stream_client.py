import asyncio

import pytest

from api.streaming.client_input import StreamQuery
from api.streaming.cursor import Cursor, FrameBytes
from api.streaming.encoder import StreamEncoder
from api.streaming.stream_client import Group, StreamClient
from domain.timebase import seconds
from service.history.event_pages import EventPages
from service.supervisor import Supervisor
from tests.support.frames import frame
from tests.support.kept_events import history_of
from tests.support.live_robot import make_supervisor
from tests.support.manual_clock import ManualClock

STATE = StreamQuery(frozenset({"system_state"}), None, None)


class Wire(asyncio.WriteTransport):
    """Holds as many bytes as a test says."""

    def __init__(self) -> None:
        super().__init__()
        self.waiting = 0
        self.closing = False

    def get_write_buffer_size(self) -> int:
        return self.waiting

    def is_closing(self) -> bool:
        return self.closing


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def supervisor(clock: ManualClock) -> Supervisor:
    return make_supervisor(clock)


@pytest.fixture
def group(supervisor: Supervisor) -> Group:
    return Group(Cursor(supervisor, EventPages(history_of(supervisor)), STATE))


@pytest.fixture
def client(group: Group, supervisor: Supervisor, clock: ManualClock) -> StreamClient:
    client = StreamClient(
        group, Wire(), Cursor(supervisor, EventPages(history_of(supervisor)), STATE), "page", clock
    )
    group.add(client)
    return client


def wire_of(client: StreamClient) -> Wire:
    assert isinstance(client.transport, Wire)
    return client.transport


def test_a_new_client_is_apart_until_it_is_level_with_the_group(
    group: Group, client: StreamClient, supervisor: Supervisor
) -> None:
    encoded = FrameBytes(StreamEncoder(supervisor))
    supervisor.frames.publish(frame(1, full=True))
    group.cursor.take(encoded)

    group.take_in_if_level(client)
    assert not group.in_step
    client.cursor.take(encoded)
    group.take_in_if_level(client)

    assert list(group.in_step.values()) == [client]
    assert not group.apart


def test_a_client_that_has_not_taken_all_stays_apart(group: Group, client: StreamClient) -> None:
    wire_of(client).waiting = 1

    group.take_in_if_level(client)

    assert not group.in_step


def test_a_clogged_client_goes_on_from_where_the_group_is(
    group: Group, client: StreamClient, supervisor: Supervisor
) -> None:
    group.take_in_if_level(client)
    supervisor.frames.publish(frame(1, full=True))
    group.cursor.take(FrameBytes(StreamEncoder(supervisor)))

    client.clogged()

    assert list(group.apart.values()) == [client]
    assert client.cursor.position == group.cursor.position
    assert client.cursor is not group.cursor


def test_a_client_that_clogs_while_apart_keeps_its_place(
    group: Group, client: StreamClient
) -> None:
    cursor = client.cursor

    client.clogged()

    assert client.cursor is cursor
    assert group.clients == (client,)


def test_a_client_that_is_lost_is_forgotten_and_comes_back_by_nothing(
    group: Group, client: StreamClient
) -> None:
    client.lost()
    client.clogged()
    group.take_in_if_level(client)

    assert group.is_empty


def test_who_still_owes_an_answer_when_it_is_due_is_slow(
    group: Group, client: StreamClient
) -> None:
    group.ask_all(judged=True)
    client.answered()
    group.part_from_late()
    assert not client.is_slow

    group.ask_all(judged=True)
    group.part_from_late()
    assert client.is_slow
    assert list(group.apart.values()) == [client]


def test_many_who_are_late_at_once_are_slow_only_if_they_miss_the_next_ping(
    group: Group, client: StreamClient, clock: ManualClock
) -> None:
    many = [
        StreamClient(group, Wire(), client.cursor.copy(), f"page {n}", clock) for n in range(10)
    ]
    for one in many:
        group.add(one)

    group.ask_all(judged=True)
    group.part_from_late()
    assert not any(one.is_slow for one in many)

    group.ask_all(judged=True)
    assert all(one.is_slow for one in many)


def test_to_whom_something_waits_the_ping_may_not_have_come(
    group: Group, client: StreamClient
) -> None:
    group.ask_all(judged=True)
    wire_of(client).waiting = 10

    group.part_from_late()
    assert not client.is_slow


def test_a_slow_client_is_written_to_when_it_has_answered(
    group: Group, client: StreamClient, clock: ManualClock
) -> None:
    group.ask_all(judged=True)
    group.part_from_late()
    assert not client.is_ready(clock.now())

    client.answered()
    assert client.is_ready(clock.now())


def test_a_slow_client_that_skips_nothing_for_a_while_is_written_to_with_the_others_again(
    group: Group, client: StreamClient, clock: ManualClock
) -> None:
    """As after a pause of the whole service, in which nobody could answer in time."""
    group.ask_all(judged=True)
    group.part_from_late()
    client.note_asked(skipped=3)
    client.answered()

    group.take_in_if_level(client)
    assert client.is_slow

    clock.stall(10)
    client.note_asked(skipped=0)
    group.take_in_if_level(client)
    assert not client.is_slow
    assert list(group.in_step.values()) == [client]


def test_a_client_is_ready_when_nothing_waits_and_it_is_there(
    client: StreamClient, clock: ManualClock
) -> None:
    assert client.is_ready(clock.now())
    wire_of(client).waiting = 1
    assert not client.is_ready(clock.now())
    wire_of(client).waiting = 0
    wire_of(client).closing = True
    assert not client.is_ready(clock.now())


def test_a_client_is_stuck_when_nothing_was_taken_for_too_long(client: StreamClient) -> None:
    wire_of(client).waiting = 100
    client.clogged()
    client.is_ready(seconds(2))
    assert not client.is_stuck(seconds(4.5))
    assert client.is_stuck(seconds(4.6))

    wire_of(client).waiting = 99
    client.is_ready(seconds(6))
    assert not client.is_stuck(seconds(10))
    wire_of(client).closing = True
    assert not client.is_stuck(seconds(20))
