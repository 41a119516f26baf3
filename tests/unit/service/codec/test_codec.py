import json
import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from domain.actor import Actor
from domain.events.driving import DriveAvailable
from domain.events.event import RecordedEvent
from domain.inputs import HoldRequest, NodeReport, Reading, Readings, TimePassed
from domain.kept import KeptHold
from domain.lifecycle import LifecycleState
from domain.parameters import ParameterValue
from domain.state_and_mode import PartName
from service.codec.codec import (
    COMMANDS,
    EVENTS,
    INPUTS,
    KEPT,
    MAX_BYTES,
    VERSION,
    Codec,
    require_version,
)
from service.codec.errors import CodecError
from service.codec.json_text import Json
from tests.support.records import EVENT_CLASSES, RECORDS, is_same, values_of

ALL = [pytest.param(kind, codec, id=kind.__name__) for kind, codec in RECORDS]
EXAMPLES = 30
"""Of each class."""

plain = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)


def hold(**fields: object) -> bytes:
    return json.dumps({"is": "hold_request", "owner": "ada", "reason": "pause"} | fields).encode()


# --- round trip ----------------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "codec"), ALL)
@settings(max_examples=EXAMPLES)
@given(data=st.data())
def test_what_is_read_is_what_was_written(
    kind: type, codec: Codec[Any], data: st.DataObject
) -> None:
    value = data.draw(values_of(kind))

    assert is_same(codec.decode(codec.encode(value)), value)


@pytest.mark.parametrize("kind", EVENT_CLASSES, ids=lambda kind: kind.kind)
@settings(max_examples=EXAMPLES)
@given(data=st.data())
def test_an_event_of_each_kind_is_read_as_it_was_written(kind: type, data: st.DataObject) -> None:
    recorded = RecordedEvent(7, 2, None, Actor(), data.draw(values_of(kind)))

    assert is_same(EVENTS.decode(EVENTS.encode(recorded)), recorded)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, -0.0, 0.1 + 0.2, 5e-324, "NaN"])
def test_a_float_that_json_does_not_have_is_no_text(value: float | str) -> None:
    reading = Readings((Reading("battery", value),), "ros")

    text = INPUTS.encode(reading)

    assert is_same(INPUTS.decode(text), reading)
    json.loads(text, parse_constant=pytest.fail)


@pytest.mark.parametrize("value", [1, 1.0, True, "1", 2**80, (1, 2), (1.0, 2.0), (True,), ()])
def test_a_parameter_keeps_its_type(value: ParameterValue) -> None:
    report = NodeReport(PartName("arm"), parameters={"gain": value})

    assert is_same(INPUTS.decode(INPUTS.encode(report)), report)


def test_a_record_names_its_class_and_leaves_out_what_is_none() -> None:
    report = NodeReport(PartName("left/arm"), LifecycleState.ACTIVE)

    assert INPUTS.encode(report) == b'{"is":"node_report","node":"left/arm","state":"active"}'


def test_an_event_is_named_as_clients_know_it() -> None:
    text = EVENTS.encode(RecordedEvent(1, 2, None, Actor("ada"), DriveAvailable()))

    assert json.loads(text) == {
        "is": "recorded_event",
        "id": 1,
        "at": 2,
        "cause": None,
        "actor": {"name": "ada"},
        "event": {"is": "drive.available"},
    }


# --- records of other releases -------------------------------------------------------------------


def test_an_unknown_field_is_ignored() -> None:
    assert INPUTS.decode(hold(colour="red")) == HoldRequest("ada", "pause")


def test_a_field_with_a_default_may_be_missing() -> None:
    assert INPUTS.decode(b'{"is": "node_report", "node": "arm"}') == NodeReport(PartName("arm"))


def test_a_newer_version_is_not_read() -> None:
    require_version(VERSION)

    with pytest.raises(CodecError, match=r"version 2; this release reads 1 to 1"):
        require_version(VERSION + 1)


# --- what is no record ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "not JSON"),
        (b"[1, NaN]", "not JSON"),
        (b"\xff", "not JSON"),
        (b"[" * 100_000, "not JSON"),
        (b"9" * 5_000, "not JSON"),
        (b"[]", "expected an object, not a list"),
        (b"{}", "'is' must name the kind of the record"),
        (b'{"is": ["readings"]}', "'is' must name the kind of the record"),
        (b'{"is": "hold_requests"}', "unknown kind of record 'hold_requests'; did you mean hold_r"),
        (b'{"is": "kept_hold"}', "unknown kind of record 'kept_hold'"),
        (b'{"is": "hold_request", "owner": "ada"}', "HoldRequest needs the field 'reason'"),
        (hold(owner=1), "owner: expected a text, not an integer"),
        (hold(actor={"name": None}), "actor.name: expected a text, not null"),
        (hold(actor=[]), "actor: expected an object, not a list"),
        (
            b'{"is": "readings", "source": "ros", "items": [{"signal": "a", "value": 1}, {}]}',
            r"items\[1\]: Reading needs the field 'signal'",
        ),
        (
            b'{"is": "readings", "source": "ros", "items": [{"signal": "a", "value": []}]}',
            r"items\[0\].value: expected true or false or a number or an integer or an object or a",
        ),
        (
            b'{"is": "readings", "source": "ros", "items": [{"signal": "a", "value": {}}]}',
            r'value: expected a number, or {"float": nan|inf|-inf}',
        ),
        (b'{"is": "service_stall", "late": true}', "late: expected an integer, not true or false"),
        (
            b'{"is": "node_report", "node": "arm", "state": "broken"}',
            "state: 'broken' is none of unknown, ",
        ),
        (
            b'{"is": "node_report", "node": "arm", "parameters": {"gain": [1, "2"]}}',
            r"parameters.gain\[0\]: expected a text, not an integer",
        ),
        (
            b'{"is": "readings", "source": "", "items": [{"signal": "a", "value": 1%s}]}'
            % (b"0" * 400),
            "this integer is too large for a number",
        ),
    ],
)
def test_what_is_no_record_is_rejected_with_the_place(text: bytes, message: str) -> None:
    with pytest.raises(CodecError, match=message):
        INPUTS.decode(text)


def test_a_record_that_is_too_long_is_not_even_parsed() -> None:
    with pytest.raises(CodecError, match=f"at most {MAX_BYTES} bytes, not {MAX_BYTES + 1}"):
        INPUTS.decode(b"[" * (MAX_BYTES + 1))


def test_only_records_of_the_expected_kind_are_written() -> None:
    with pytest.raises(CodecError, match="TimePassed is no such record"):
        KEPT.encode(TimePassed())  # type: ignore[arg-type]


def test_half_a_surrogate_pair_cannot_be_written() -> None:
    with pytest.raises(CodecError, match="cannot be written as JSON"):
        KEPT.encode(KeptHold("ada", "\ud800", "ada", 0))


@pytest.mark.parametrize(("kind", "codec"), ALL)
@settings(max_examples=EXAMPLES)
@given(data=st.data())
def test_a_record_that_was_tampered_with_is_read_or_rejected(
    kind: type, codec: Codec[Any], data: st.DataObject
) -> None:
    record = json.loads(codec.encode(data.draw(values_of(kind))))
    tampered = data.draw(tampering(record))

    try:
        value = codec.decode(json.dumps(tampered).encode("utf-8", "surrogatepass"))
    except CodecError:
        return
    assert type(value) in {kind for kind, of in RECORDS if of is codec}


@given(plain)
def test_any_other_json_is_rejected(value: object) -> None:
    for codec in (INPUTS, COMMANDS, EVENTS, KEPT):
        with pytest.raises(CodecError):
            codec.decode(json.dumps(value).encode())


@given(st.binary())
def test_any_other_bytes_are_rejected(text: bytes) -> None:
    with pytest.raises(CodecError):
        INPUTS.decode(text)


@st.composite
def tampering(draw: st.DrawFn, record: Json) -> Json:
    """Return JSON with something changed, left out or added at one place."""
    keys = list(record) if isinstance(record, dict) else list(range(len(record)))
    if not keys:
        return draw(plain)
    key = draw(st.sampled_from(keys))
    inner = record[key]
    if isinstance(inner, dict | list) and draw(st.booleans()):
        return _with(record, key, draw(tampering(inner)))
    if draw(st.booleans()):
        return _with(record, key, draw(plain))
    if isinstance(record, dict):
        return {name: item for name, item in record.items() if name != key}
    return record[:key]


def _with(record: Json, key: str | int, item: Json) -> Json:
    changed = record.copy()
    changed[key] = item
    return changed
