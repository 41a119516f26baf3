"""The stamp of a serialized message."""

from struct import pack

import pytest

from service.ros.graph.header import begins_with_header, stamp_in

LITTLE, BIG = b"\x00\x01\x00\x00", b"\x00\x00\x00\x00"


def test_the_stamp_is_read_in_the_order_of_bytes_that_the_message_names() -> None:
    stamp_ns = 1_700_000_000_000_000_005

    assert stamp_in(LITTLE + pack("<iI", 1_700_000_000, 5) + b"a frame and points") == stamp_ns
    assert stamp_in(BIG + pack(">iI", 1_700_000_000, 5)) == stamp_ns


@pytest.mark.parametrize("serialized", [b"", LITTLE, LITTLE + b"1234567"])
def test_a_message_that_is_too_short_has_no_stamp(serialized: bytes) -> None:
    assert stamp_in(serialized) is None


def test_a_stamp_that_nobody_set_is_none() -> None:
    assert stamp_in(LITTLE + bytes(8)) is None


def test_only_a_header_at_the_begin_counts() -> None:
    assert begins_with_header({"header": "std_msgs/Header", "ranges": "sequence<float>"})
    assert not begins_with_header({"child": "string", "header": "std_msgs/Header"})
    assert not begins_with_header({})
