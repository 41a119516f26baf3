import json
from typing import Any

import pytest

from api.streaming.client_input import StreamQuery
from api.streaming.cursor import Cursor, FrameBytes
from api.streaming.encoder import StreamEncoder
from service.event_log import Gap
from service.history.event_pages import EventPages
from service.supervisor import Supervisor
from tests.support.frames import event, frame, part_view
from tests.support.kept_events import history_of
from tests.support.live_robot import make_supervisor
from tests.support.websocket import texts_of

ALL = frozenset({"system_state", "parts", "events"})


@pytest.fixture
def supervisor() -> Supervisor:
    return make_supervisor()


@pytest.fixture
def encoded(supervisor: Supervisor) -> FrameBytes:
    return FrameBytes(StreamEncoder(supervisor))


def read(content: bytes) -> list[dict[str, Any]]:
    return [json.loads(text) for text in texts_of(content)]


def cursor_of(supervisor: Supervisor, topics: frozenset[str], after: int | None) -> Cursor:
    pages = EventPages(history_of(supervisor))
    return Cursor(supervisor, pages, StreamQuery(topics, after, None))


def from_now_on(supervisor: Supervisor) -> Cursor:
    return cursor_of(supervisor, ALL, None)


def test_bytes_are_made_once_for_all_who_missed_as_much(encoded: FrameBytes) -> None:
    published = frame(9, [part_view("arm")], full=True)

    assert encoded.frame(published, 0, ALL) is encoded.frame(published, 0, ALL)
    assert encoded.frame(published, 3, ALL) is encoded.frame(published, 3, ALL)
    assert encoded.frame(published, 3, ALL) is not encoded.frame(published, 0, ALL)


def test_events_are_made_once_and_a_gap_for_whoever_has_it(encoded: FrameBytes) -> None:
    assert encoded.event(event(1)) is encoded.event(event(1))
    assert read(encoded.event(Gap(1, 4, "e1")))[0]["type"] == "gap"


def test_a_place_moves_on_to_the_newest_frame_and_past_the_events(
    supervisor: Supervisor, encoded: FrameBytes
) -> None:
    cursor = from_now_on(supervisor)
    supervisor.frames.publish(frame(1, full=True))
    supervisor.events.append(event(1))

    content, skipped = cursor.take(encoded)

    assert [found["type"] for found in read(content)] == ["event", "state"]
    assert skipped == 0
    assert cursor.take(encoded) == (b"", 0)


def test_frames_that_were_replaced_meanwhile_are_skipped_and_counted(
    supervisor: Supervisor, encoded: FrameBytes
) -> None:
    cursor = from_now_on(supervisor)
    supervisor.frames.publish(frame(1, full=True))
    cursor.take(encoded)
    for seq in (2, 3, 4):
        supervisor.frames.publish(frame(seq))

    content, skipped = cursor.take(encoded)

    assert skipped == 2
    assert [(found["seq"], found["skipped"]) for found in read(content)] == [(4, 2)]


def test_many_events_are_taken_some_at_a_time(supervisor: Supervisor, encoded: FrameBytes) -> None:
    cursor = cursor_of(supervisor, frozenset({"events"}), 0)
    for number in range(1, 301):
        supervisor.events.append(event(number))

    first, second = cursor.take(encoded)[0], cursor.take(encoded)[0]

    assert (len(read(first)), len(read(second))) == (256, 44)
    assert not cursor.has_events


def test_a_copy_goes_its_own_way(supervisor: Supervisor, encoded: FrameBytes) -> None:
    cursor = from_now_on(supervisor)
    supervisor.frames.publish(frame(1, full=True))
    supervisor.events.append(event(1))
    copy = cursor.copy()
    assert copy.position == cursor.position

    cursor.take(encoded)

    assert copy.position != cursor.position
    assert len(read(copy.take(encoded)[0])) == 2
    assert copy.position == cursor.position
