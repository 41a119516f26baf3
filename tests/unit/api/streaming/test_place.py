import json
from typing import Any

import pytest

from api.streaming.encoder import StreamEncoder
from api.streaming.place import News, Place
from api.streaming.query import StreamQuery
from service.event_log import Gap
from service.supervisor import Supervisor
from tests.support.frames import event, frame, part_view
from tests.support.live_robot import make_supervisor
from tests.support.websocket import texts_of

ALL = frozenset({"system_state", "parts", "events"})


@pytest.fixture
def supervisor() -> Supervisor:
    return make_supervisor()


@pytest.fixture
def news(supervisor: Supervisor) -> News:
    return News(StreamEncoder(supervisor))


def read(content: bytes) -> list[dict[str, Any]]:
    return [json.loads(text) for text in texts_of(content)]


def from_now_on(supervisor: Supervisor) -> Place:
    return Place(supervisor, StreamQuery(ALL, None, None))


def test_bytes_are_made_once_for_all_who_missed_as_much(news: News) -> None:
    published = frame(9, [part_view("arm")], full=True)

    assert news.frame(published, 0, ALL) is news.frame(published, 0, ALL)
    assert news.frame(published, 3, ALL) is news.frame(published, 3, ALL)
    assert news.frame(published, 3, ALL) is not news.frame(published, 0, ALL)


def test_events_are_made_once_and_a_gap_for_whoever_has_it(news: News) -> None:
    assert news.event(event(1)) is news.event(event(1))
    assert read(news.event(Gap(1, 4, "e1")))[0]["type"] == "gap"


def test_a_place_moves_on_to_the_newest_frame_and_past_the_events(
    supervisor: Supervisor, news: News
) -> None:
    place = from_now_on(supervisor)
    supervisor.frames.publish(frame(1, full=True))
    supervisor.events.append(event(1))

    content, skipped = place.take(news)

    assert [found["type"] for found in read(content)] == ["event", "state"]
    assert skipped == 0
    assert place.take(news) == (b"", 0)


def test_frames_that_were_replaced_meanwhile_are_skipped_and_counted(
    supervisor: Supervisor, news: News
) -> None:
    place = from_now_on(supervisor)
    supervisor.frames.publish(frame(1, full=True))
    place.take(news)
    for seq in (2, 3, 4):
        supervisor.frames.publish(frame(seq))

    content, skipped = place.take(news)

    assert skipped == 2
    assert [(found["seq"], found["skipped"]) for found in read(content)] == [(4, 2)]


def test_many_events_are_taken_some_at_a_time(supervisor: Supervisor, news: News) -> None:
    place = Place(supervisor, StreamQuery(frozenset({"events"}), 0, None))
    for number in range(1, 41):
        supervisor.events.append(event(number))

    first, second = place.take(news)[0], place.take(news)[0]

    assert (len(read(first)), len(read(second))) == (32, 8)
    assert not place.has_events


def test_a_copy_goes_its_own_way(supervisor: Supervisor, news: News) -> None:
    place = from_now_on(supervisor)
    supervisor.frames.publish(frame(1, full=True))
    supervisor.events.append(event(1))
    copy = place.copy()
    assert copy.position == place.position

    place.take(news)

    assert copy.position != place.position
    assert len(read(copy.take(news)[0])) == 2
    assert copy.position == place.position
