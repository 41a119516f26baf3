"""Cuts what a WebSocket client sends into pieces of few frames (RFC 6455, section 5.2)."""

from websockets.frames import Opcode

from api.serving.pieces import FRAME_COST, INCOMPLETE, MESSAGE_COST, Piece, cost_of_bytes

MAX_FRAMES = 16
"""In one piece."""
MAX_BYTES = 8_192
"""In one piece; longer frames are handed on in several."""
_FINAL = 0x80


class FramePieces:
    """The position between frames, so that each piece ends where a frame or its part ends."""

    def __init__(self) -> None:
        self._left = 0
        """Bytes of the current frame that were not handed on."""
        self._ends_message = False

    def next(self, waiting: bytes | bytearray) -> Piece:
        """Return the next piece: at most one message, and `MAX_FRAMES` frames without one."""
        if self._left:
            length = min(self._left, len(waiting), MAX_BYTES)
            self._left -= length
            ends = self._ends_message and not self._left
            return Piece(length, cost_of_bytes(length) + (MESSAGE_COST if ends else 0))
        at = frames = 0
        while frames < MAX_FRAMES and at < MAX_BYTES:
            head = _head_of(waiting, at)
            if head is None:
                break
            frames += 1
            is_message = bool(waiting[at] & _FINAL) and (waiting[at] & 0x0F) < Opcode.CLOSE
            end = at + sum(head)
            if end > len(waiting) or sum(head) > MAX_BYTES:
                return self._part(waiting, at, end, frames, is_message=is_message)
            at = end
            if is_message:
                return Piece(at, MESSAGE_COST + frames * FRAME_COST + cost_of_bytes(at))
        return Piece(at, frames * FRAME_COST + cost_of_bytes(at)) if frames else INCOMPLETE

    def _part(
        self, waiting: bytes | bytearray, at: int, end: int, frames: int, *, is_message: bool
    ) -> Piece:
        """Return a piece that ends within a frame, after its head."""
        length = min(len(waiting), max(at + 14, MAX_BYTES), end)
        self._left = end - length
        self._ends_message = is_message
        return Piece(length, frames * FRAME_COST + cost_of_bytes(length))


def _head_of(waiting: bytes | bytearray, at: int) -> tuple[int, int] | None:
    """Return the lengths of the head and the payload of the frame; None: the head is incomplete."""
    if len(waiting) < at + 2:
        return None
    length = waiting[at + 1] & 0x7F
    extra = {126: 2, 127: 8}.get(length, 0)
    head = 2 + extra + (4 if waiting[at + 1] & 0x80 else 0)
    if len(waiting) < at + head:
        return None
    if extra:
        length = int.from_bytes(waiting[at + 2 : at + 2 + extra])
    return head, length
