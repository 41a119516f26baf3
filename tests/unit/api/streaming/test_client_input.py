import json

import pytest
from starlette.datastructures import QueryParams

from api.http.body_parsing import InvalidBodyError
from api.http.schemas.stream import AuthMessage, ReadingMessage, ResyncMessage
from api.streaming.client_input import TOPICS, read_client_message, read_stream_query
from domain.errors import InvalidValueError, PilothouseError


def test_who_asks_for_nothing_gets_every_topic_and_new_events() -> None:
    query = read_stream_query(QueryParams({}))

    assert query.topics == set(TOPICS)
    assert (query.after, query.epoch) == (None, None)
    assert query.wants_state
    assert query.wants_events


def test_topics_are_chosen_by_name() -> None:
    query = read_stream_query(QueryParams({"topics": "parts, signals"}))

    assert query.topics == {"parts", "signals"}
    assert query.wants_state
    assert not query.wants_events


def test_events_alone_come_without_state_frames() -> None:
    query = read_stream_query(QueryParams({"topics": "events", "after": "88", "epoch": "E1"}))

    assert not query.wants_state
    assert (query.after, query.epoch) == (88, "E1")


@pytest.mark.parametrize("topics", ["partz", "parts,partz", "parts;signals", "Parts"])
def test_an_unknown_topic_is_refused_with_those_there_are(topics: str) -> None:
    with pytest.raises(InvalidValueError, match="system_state, parts, signals") as refused:
        read_stream_query(QueryParams({"topics": topics}))

    assert refused.value.pointer == "/topics"


@pytest.mark.parametrize("topics", ["", ",", " , "])
def test_no_topic_at_all_is_refused(topics: str) -> None:
    with pytest.raises(InvalidValueError, match="no topic is named"):
        read_stream_query(QueryParams({"topics": topics}))


@pytest.mark.parametrize("after", ["", "-1", "1.0", "1e3", " 1", "1_0", "x", "\u0663", "9" * 19])
def test_what_is_no_event_id_is_refused(after: str) -> None:
    with pytest.raises(InvalidValueError, match="invalid event id") as refused:
        read_stream_query(QueryParams({"after": after}))

    assert refused.value.pointer == "/after"


def test_a_reading_is_read() -> None:
    text = '{"type":"reading","signal":"estop","value":true,"source":"pendant"}'

    given = read_client_message({"type": "websocket.receive", "text": text})

    assert isinstance(given, ReadingMessage)
    assert (given.signal, given.value, given.source) == ("estop", True, "pendant")


def test_who_measured_may_be_left_out() -> None:
    text = '{"type":"reading","signal":"battery_level","value":1}'

    given = read_client_message({"text": text})

    assert isinstance(given, ReadingMessage)
    assert given.source is None


def test_a_token_is_read() -> None:
    given = read_client_message({"text": '{"type":"auth","token":"secret"}'})

    assert given == AuthMessage(type="auth", token="secret")


def test_a_resync_is_read_and_holds_nothing_else() -> None:
    assert read_client_message({"text": '{"type":"resync"}'}) == ResyncMessage(type="resync")
    with pytest.raises(PilothouseError):
        read_client_message({"text": '{"type":"resync","seq":7}'})


def test_a_binary_message_is_not_read() -> None:
    with pytest.raises(InvalidValueError, match="binary"):
        read_client_message({"type": "websocket.receive", "bytes": b"{}", "text": None})


@pytest.mark.parametrize(
    "text",
    [
        '{"type":"readings","signal":"estop","value":true}',
        '{"type":"reading","signal":"","value":true}',
        '{"type":"auth"}',
        '{"type":"reading","signal":"estop","value":[true]}',
        '{"type":"reading","signal":"estop","value":true,"stamp":1}',
    ],
    ids=["unknown type", "no name", "no token", "a list", "a stamp that is no text"],
)
def test_what_is_no_reading_is_refused(text: str) -> None:
    with pytest.raises(PilothouseError):
        read_client_message({"text": text})


def test_repeated_topics_are_taken_together() -> None:
    query = read_stream_query(QueryParams("topics=parts&topics=signals,task"))

    assert query.topics == {"parts", "signals", "task"}


@pytest.mark.parametrize("kind", ["zzz", None, ["reading"], {}])
def test_an_unknown_message_type_is_refused_with_those_there_are(kind: object) -> None:
    with pytest.raises(InvalidValueError, match="'reading', 'resync', 'auth'"):
        read_client_message({"text": json.dumps({"type": kind})})


def test_a_message_with_very_many_members_is_refused_with_one_fault() -> None:
    said = {"type": "reading", **{f"k{number}": 1 for number in range(5_000)}}

    with pytest.raises(InvalidBodyError, match="more than 1000 members") as refused:
        read_client_message({"text": json.dumps(said)})
    assert len(refused.value.faults) == 1
