"""Messages of the link as bytes, and back.

The first byte says how the rest is written: as JSON, or as JSON that zlib made smaller.
"""

import zlib

from domain.errors import shortened
from domain.link.messages import Message, Report
from domain.link.pieces import MAX_PIECES, cut
from service.codec.codec import MAX_MESSAGE_BYTES, MESSAGES
from service.codec.errors import CodecError

PACKED_FROM = 1_000
"""Bytes from which a message is made smaller; a beat is shorter, and must not wait for that."""

_COUNTS = (2, 4, 8, MAX_PIECES)
"""Into how many pieces a report is cut: into as few of these as suffice."""

_PLAIN = b"j"
_PACKED = b"z"
_LEVEL = 1
"""Of zlib, the fastest one: 186 kB, the complete report of a thousand nodes, take it 1 ms."""


def encode(message: Message) -> bytes:
    """Return a message as bytes.

    Raises:
        CodecError: It holds half a surrogate pair, or is too long to be read again.
    """
    return _packed(MESSAGES.encode(message))


def encode_in_pieces(message: Message) -> list[bytes]:
    """Return a message as bytes: a report that is too long in pieces, anything else as one.

    Raises:
        CodecError: It holds half a surrogate pair, or is too long also in pieces.
    """
    text = MESSAGES.encode(message)
    if len(text) > MAX_MESSAGE_BYTES and isinstance(message, Report):
        for count in _COUNTS:
            texts = [MESSAGES.encode(piece) for piece in cut(message, count)]
            if max(map(len, texts)) <= MAX_MESSAGE_BYTES:
                return [_packed(each) for each in texts]
    return [_packed(text)]


def _packed(text: bytes) -> bytes:
    if len(text) > MAX_MESSAGE_BYTES:
        raise CodecError(f"a message has at most {MAX_MESSAGE_BYTES} bytes, not {len(text)}")
    if len(text) < PACKED_FROM:
        return _PLAIN + text
    return _PACKED + zlib.compress(text, _LEVEL)


def decode(data: bytes) -> Message:
    """Return the message that `encode` was given, or one of another release.

    Args:
        data: From anywhere.

    Raises:
        CodecError: It is no message; what is said of it is short.
    """
    form, rest = data[:1], data[1:]
    if form not in (_PLAIN, _PACKED):
        raise CodecError("a message begins with j or z")
    try:
        return MESSAGES.decode(rest if form == _PLAIN else _unpacked(rest))
    except CodecError as error:
        # It may repeat a name of any length.
        raise CodecError(shortened(error.message)) from None


def _unpacked(data: bytes) -> bytes:
    """Return what was packed, which never takes more memory than the longest message."""
    unpacking = zlib.decompressobj()
    try:
        text = unpacking.decompress(data, MAX_MESSAGE_BYTES + 1)
    except zlib.error as error:
        raise CodecError(f"a message that cannot be unpacked: {error}") from None
    if len(text) > MAX_MESSAGE_BYTES:
        raise CodecError(f"a message has at most {MAX_MESSAGE_BYTES} bytes")
    if not unpacking.eof or unpacking.unused_data:
        raise CodecError("a message that is cut off, or goes on after its end")
    return text
