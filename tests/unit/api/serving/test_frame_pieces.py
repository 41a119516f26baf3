import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.frames import Frame, Opcode

from api.serving.frame_pieces import MAX_BYTES, MAX_FRAMES, FramePieces
from api.serving.pieces import MESSAGE_COST

_CONTROL = st.builds(Frame, st.sampled_from([Opcode.PING, Opcode.PONG]), st.binary(max_size=125))
_FRAMES = _CONTROL | st.builds(
    Frame,
    st.sampled_from([Opcode.CONT, Opcode.TEXT, Opcode.BINARY]),
    st.integers(0, 70_000).map(bytes) | st.binary(max_size=10),
    st.booleans(),
)


def pieces_of(data: bytes, arrives: int) -> list[bytes]:
    """Return the pieces of what arrives so many bytes at a time."""
    cutter, waiting, found = FramePieces(), bytearray(), []
    for at in range(0, len(data), arrives):
        waiting += data[at : at + arrives]
        while waiting and (piece := cutter.next(waiting)).length:
            assert piece.cost > 0
            found.append(bytes(waiting[: piece.length]))
            del waiting[: piece.length]
    return found


@given(st.lists(_FRAMES, max_size=30), st.integers(1, 20_000))
def test_the_pieces_are_what_was_sent_and_each_is_small(frames: list[Frame], arrives: int) -> None:
    data = b"".join(frame.serialize(mask=True) for frame in frames)

    pieces = pieces_of(data, max(arrives, len(data) // 1_000))

    assert b"".join(pieces) == data
    assert all(len(piece) <= MAX_BYTES + 14 for piece in pieces)


@pytest.mark.parametrize("frame", [b"\x89\x80\0\0\0\0", b"\x8a\x80\0\0\0\0", b"\x00\x80\0\0\0\0"])
def test_a_flood_of_empty_frames_is_cut_into_few_at_a_time(frame: bytes) -> None:
    pieces = pieces_of(frame * 5_000, 16_384)

    assert max(len(piece) for piece in pieces) == MAX_FRAMES * len(frame)


def test_one_message_is_handed_on_at_a_time() -> None:
    text = b"\x81\x80\0\0\0\0"

    piece = FramePieces().next(text * 100)

    assert piece.length == len(text)
    assert piece.cost >= MESSAGE_COST


@given(st.binary(max_size=2_000), st.integers(1, 300))
def test_whatever_arrives_is_cut(data: bytes, arrives: int) -> None:
    assert data.startswith(b"".join(pieces_of(data, arrives)))
