import pytest

from api.streaming.query import TOPICS, read_stream_query
from domain.errors import InvalidValueError


def test_who_asks_for_nothing_gets_every_topic_and_new_events() -> None:
    query = read_stream_query({})

    assert query.topics == set(TOPICS)
    assert (query.after, query.epoch) == (None, None)
    assert query.wants_state
    assert query.wants_events


def test_topics_are_chosen_by_name() -> None:
    query = read_stream_query({"topics": "parts, signals"})

    assert query.topics == {"parts", "signals"}
    assert query.wants_state
    assert not query.wants_events


def test_events_alone_come_without_state_frames() -> None:
    query = read_stream_query({"topics": "events", "after": "88", "epoch": "E1"})

    assert not query.wants_state
    assert (query.after, query.epoch) == (88, "E1")


@pytest.mark.parametrize("topics", ["partz", "parts,partz", "parts;signals", "Parts"])
def test_an_unknown_topic_is_refused_with_those_there_are(topics: str) -> None:
    with pytest.raises(InvalidValueError, match="system_state, parts, signals") as refused:
        read_stream_query({"topics": topics})

    assert refused.value.pointer == "/topics"


@pytest.mark.parametrize("topics", ["", ",", " , "])
def test_no_topic_at_all_is_refused(topics: str) -> None:
    with pytest.raises(InvalidValueError, match="no topic is named"):
        read_stream_query({"topics": topics})


@pytest.mark.parametrize("after", ["", "-1", "1.0", "1e3", " 1", "1_0", "x", "\u0663", "9" * 19])
def test_what_is_no_event_id_is_refused(after: str) -> None:
    with pytest.raises(InvalidValueError, match="no id of an event") as refused:
        read_stream_query({"after": after})

    assert refused.value.pointer == "/after"
