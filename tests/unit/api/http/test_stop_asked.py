"""What asks for a stop, in whatever message it is."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from api.http.stop_asked import (
    is_stop_of_rosbridge,
    is_stop_of_stream,
    may_ask_rosbridge,
    members_of,
    source_of,
    stop_body,
)

KEPT = {"source": 4}


@pytest.mark.parametrize(
    ("raw", "body"),
    [
        (b'{"value":true}', {"value": True}),
        (b'\xef\xbb\xbf{"value":1.0}', {"value": True}),
        (b'{"value":false,"value":"yes"}', {"value": True}),
        (b'{"value":true,"source":"panel"}', {"value": True, "source": "pane"}),
        (b'{"value":true,"source":7,"source":"a"}', {"value": True, "source": "a"}),
        (b'{"value":true,"source":"\\ud800"}', {"value": True, "source": "?"}),
        (b"{'value': True}", {"value": True}),
        (b'{"value":true', {"value": True}),
        (b"value=1&source=x", {"value": True}),
        (b'{"value":false}', None),
        (b'{"value":10}', None),
        (b"value=10", None),
        (b'{"value": trueish', None),
        (b'{"values":true', None),
        (b'{"in":[{"value":true}]}', {"value": True}),
        (b'[{"value":true,"source":"a"}]', {"value": True}),
        (b'{"value":{"value":true}}', {"value": True}),
        (b'{"value":{"enabled":1}}', {"value": True}),
        (b'{"value":[{"data":"on"}]}', {"value": True}),
        (b'[{"signal":"door","value":7},{"signal":"/estop","value":true}]', {"value": True}),
        (b'{"Value":true}', {"value": True}),
        (b'{"/value":true}', {"value": True}),
        ('{"value":true}'.encode("utf-16"), {"value": True}),
        ('{"value":true,'.encode("utf-16-be"), {"value": True}),
        (b'["value",true]', None),
        (b"true", None),
        (b'{"enabled":true}', None),
        (b'{"value":[true]}', None),
        (b"", None),
    ],
)
def test_a_body_that_asks_for_a_stop_is_cut_down_to_what_is_valid(
    raw: bytes, body: dict[str, object] | None
) -> None:
    assert stop_body(raw, "value", KEPT) == body


@given(st.binary(max_size=200))
def test_any_bytes_are_looked_at_without_a_fault(raw: bytes) -> None:
    stop_body(raw, "value", KEPT)
    is_stop_of_stream({"bytes": raw})
    is_stop_of_rosbridge({"text": raw.decode(errors="surrogateescape")})
    members_of({"bytes": raw})


@pytest.mark.parametrize(
    "part", ["value:", "value: ", "value: '", "value: 1.0x", " ", '"op":', '"op":"', '"signal":"/']
)
def test_a_long_text_is_looked_at_in_linear_time(part: str) -> None:
    """If whitespace were tried at two places, this would take minutes."""
    for text in (part * (250_000 // len(part)), part + " " * 250_000, part + "0" * 250_000):
        assert stop_body(text.encode(), "value", KEPT) is None
        assert not is_stop_of_stream({"text": text})
        assert not is_stop_of_rosbridge({"text": text})
        members_of({"text": text})


@pytest.mark.parametrize(
    "text",
    [
        '{"value":' * 900 + "0" + "}" * 900,
        '{"signal":"estop","x":' * 900 + "0" + "}" * 900,
        '{"topic":"estop","msg":' * 900 + "0" + "}" * 900,
        "[" + "{}," * 80_000 + "0]",
        '{"value":[' + '{"b":1},' * 30_000 + "0]}",
    ],
)
def test_each_object_of_what_is_nested_is_looked_at_once(text: str) -> None:
    """If each were looked at from each one around it, this would take minutes."""
    for _ in range(20):
        assert stop_body(text.encode(), "value", KEPT) is None
        assert not is_stop_of_stream({"text": text})
        assert not is_stop_of_rosbridge({"text": text})


def test_nothing_of_another_signal_or_topic_asks_for_a_stop() -> None:
    assert not is_stop_of_stream({"text": '{"signal":"door","value":true}'})
    assert not is_stop_of_stream({"text": '{"signal":"estop"}'})
    apart = '[{"signal":"estop","value":false},{"signal":"door","value":1}]'
    assert not is_stop_of_stream({"text": apart})
    assert not is_stop_of_rosbridge({"text": '{"topic":"/door","msg":{"data":true}}'})
    assert not is_stop_of_rosbridge({"text": '{"topic":"/estop","msg":[true]}'})
    assert not is_stop_of_rosbridge({"text": '{"topic":"/estop","msg":{"enabled":false}'})


@pytest.mark.parametrize("value", [True, 1, "true", "TRUE", "yes"])
def test_what_asks_for_a_stop_may_be_told_without_parsing(value: object) -> None:
    for spacing in (None, 1):
        said = {"op": "publish", "topic": "/estop", "msg": {"enabled": value}}
        assert may_ask_rosbridge(json.dumps(said, indent=spacing))
        assert not may_ask_rosbridge(json.dumps({**said, "msg": {"enabled": False}}))


def test_the_source_of_a_reading_is_kept_if_it_is_valid() -> None:
    assert source_of({"text": '{"source":"panel"}'}, 5) == "panel"
    assert source_of({"text": '{"source":"panels"}'}, 5) is None
    assert source_of({"text": "?"}, 5) is None


def test_the_first_of_several_members_is_kept() -> None:
    assert members_of({"text": '{"id":12345678901234567,"id":"b","s":"\\ud800"}'}) == {
        "id": 12345678901234567,
        "s": "?",
    }
    assert members_of({"text": "[1]"}) == {}
