"""The time stamp at the begin of a serialized message, without decoding the rest of it.

Source: OMG DDS-XTypes 1.3, section 7.6.3 (encapsulation), and OMG CORBA 3.4, section 9.3 (CDR).
"""

from collections.abc import Mapping
from struct import Struct

from domain.timebase import NANOSECONDS_PER_SECOND

_HEADER = "std_msgs/Header"
_ENCAPSULATION_BYTES = 4
_STAMPS = (Struct(">iI"), Struct("<iI"))
"""Seconds and nanoseconds; the second byte of the encapsulation tells which of the two."""


def begins_with_header(fields: Mapping[str, str]) -> bool:
    """Tell whether messages begin with a header.

    Args:
        fields: The types of the fields, in their order, as rclpy names them.
    """
    return next(iter(fields.values()), "") == _HEADER


def stamp_in(serialized: bytes) -> int | None:
    """Return the stamp of a message that begins with a header, ns since 1970-01-01 UTC.

    None: it is 0, which means that nobody set it, or the message is too short to have one.
    """
    if len(serialized) < _ENCAPSULATION_BYTES + _STAMPS[0].size:
        return None
    stamp = _STAMPS[serialized[1] & 1]
    sec, nanosec = stamp.unpack_from(serialized, _ENCAPSULATION_BYTES)
    return (sec * NANOSECONDS_PER_SECOND + nanosec) or None
