import tracemalloc
import zlib
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.computers import ComputerName, Incarnation
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.link.messages import Message, Report
from domain.link.pieces import Pieces
from domain.state_and_mode import PartName
from service.codec.codec import MAX_MESSAGE_BYTES
from service.codec.errors import CodecError
from service.link import port
from service.link.wire import PACKED_FROM, decode, encode, encode_in_pieces
from tests.support.record_samples.messages import MESSAGES

SAMPLES = [message for messages in MESSAGES.values() for message in messages]


def report_of(nodes: int) -> Report:
    items = tuple(
        NodeReport(PartName(f"left/arm_{number}"), LifecycleState.ACTIVE, reachable=True)
        for number in range(nodes)
    )
    return Report(ComputerName("arm"), Incarnation("0f" * 16), 7, items, complete=True)


@pytest.mark.parametrize("message", SAMPLES)
def test_a_message_arrives_as_it_was_sent(message: Message) -> None:
    assert decode(encode(message)) == message


def test_a_beat_is_short_and_is_not_packed() -> None:
    (_, beat) = MESSAGES["beat"]

    data = encode(beat)

    assert data.startswith(b'j{"is":"beat"')
    assert len(data) < 500


def test_a_long_report_is_packed() -> None:
    report = report_of(1_000)

    data = encode(report)

    assert data[:1] == b"z"
    assert PACKED_FROM < len(data) < 20_000
    assert decode(data) == report


def test_a_message_that_nobody_would_read_is_not_written() -> None:
    with pytest.raises(CodecError, match="at most 1048576 bytes"):
        encode(report_of(20_000))


def test_a_report_that_is_too_long_goes_in_pieces_and_is_whole_again() -> None:
    report = report_of(20_000)

    messages = encode_in_pieces(report)
    pieces = [decode(data) for data in messages]

    assert len(messages) == 2
    together = Pieces()
    assert [together.add(piece) for piece in pieces if isinstance(piece, Report)] == [
        None,
        replace(report, complete_together=True),
    ]


def test_what_fits_goes_as_one() -> None:
    assert encode_in_pieces(report_of(1)) == [encode(report_of(1))]


def test_a_report_that_is_too_long_even_in_pieces_is_not_written() -> None:
    node = NodeReport(PartName("x" * 2**20), reachable=True)
    report = replace(report_of(1), items=(node, node))

    with pytest.raises(CodecError, match="at most 1048576 bytes"):
        encode_in_pieces(report)


def test_what_the_port_carries_is_what_can_be_read() -> None:
    assert MAX_MESSAGE_BYTES == port.MAX_MESSAGE_BYTES


def test_fields_of_a_newer_release_are_ignored() -> None:
    (_, beat) = MESSAGES["beat"]
    newer = encode(beat).replace(b'{"is":"beat"', b'{"is":"beat","mood":{"good":[1,null]}')

    assert decode(newer) == beat


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "begins with j or z"),
        (b"\x00", "begins with j or z"),
        (b'{"is":"beat"}', "begins with j or z"),
        (b"j", "not JSON"),
        (b"jnull", "expected an object"),
        (b'j{"is":"report"}', "needs the field 'sender'"),
        (b'j{"is":"mode_request","part":"arm","mode":"FAST"}', "unknown kind of record"),
        (b"j" + b"[" * 100_000, "recursion limit"),
        (b'j{"is":"beat","seq":' + b"9" * 1_000_000 + b"}", "number out of range"),
        (b"j" + b" " * MAX_MESSAGE_BYTES + b"{}", "at most 1048576 bytes"),
        (b"z", "cut off"),
        (b"znot packed", "cannot be unpacked"),
        (b"z" + zlib.compress(b"{}")[:-1], "cut off"),
        (b"z" + zlib.compress(b"{}") + b"more", "goes on after its end"),
        (b"z" + zlib.compress(zlib.compress(b"{}")), "not JSON"),
    ],
)
def test_what_is_no_message_is_refused(data: bytes, words: str) -> None:
    with pytest.raises(CodecError, match=words):
        decode(data)


def test_a_message_that_would_fill_the_memory_is_refused_before_it_does() -> None:
    bomb = b"z" + zlib.compress(b"0" * 200_000_000, 9)
    assert len(bomb) < MAX_MESSAGE_BYTES
    tracemalloc.start()

    with pytest.raises(CodecError, match="at most 1048576 bytes"):
        decode(bomb)

    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 8 * MAX_MESSAGE_BYTES


def test_what_is_said_of_a_message_stays_short() -> None:
    name = b"x" * 100_000
    order = encode(SAMPLES[-2]).replace(
        b'{"is":"ask_transition","request":41,"node":"left/arm","transition":"activate"}',
        b'{"is":"ask_parameters","request":41,"node":"a","values":{"%s":null}}' % name,
    )

    with pytest.raises(CodecError) as refused:
        decode(order)

    assert len(str(refused.value)) < 300


@given(st.binary(max_size=200))
def test_any_bytes_are_a_message_or_refused(data: bytes) -> None:
    for form in (b"", b"j", b"z"):
        refused_or_read(form + data)


@given(st.data(), st.sampled_from(SAMPLES))
def test_a_message_with_changed_bytes_is_a_message_or_refused(
    data: st.DataObject, message: Message
) -> None:
    spoiled = bytearray(encode(message))
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(spoiled) - 1))
        spoiled[at] = data.draw(st.integers(0, 255))
    refused_or_read(bytes(spoiled))
    refused_or_read(b"z" + zlib.compress(bytes(spoiled[1:])))


def refused_or_read(data: bytes) -> None:
    try:
        message = decode(data)
    except CodecError:
        return
    # What was read can be told on, with the same meaning.
    assert decode(encode(message)) == message
