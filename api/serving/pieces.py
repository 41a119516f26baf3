"""How a protocol takes what waits in its connection: in pieces whose cost is known beforehand."""

from dataclasses import dataclass

HEAD_COST = 500
"""Of a request with its answer, in nominal microseconds."""
CHANGE_COST = 1_500
"""Of one that changes something, with what is written down of it."""
HANDSHAKE_COST = 2_000
"""Of a handshake, with all that is made for the new client."""
MESSAGE_COST = 200
"""Of a WebSocket message with what it makes the service do."""
FRAME_COST = 30
"""Of a frame that is no whole message."""
KIB_COST = 20
CHECKED_KIB_COST = 200
"""Of a body that is complete and parsed now, or of a head, whose path is compared with routes."""
MAX_CHECKED_BYTES = 262_144
"""Larger bodies are parsed by a worker."""
LOSS_COST = 200
"""Of the end of a connection, with what the service does then."""
READ_COST = 5
"""Of the least that can be done."""


@dataclass(frozen=True, slots=True)
class Piece:
    """The next bytes that are handled together."""

    length: int
    """0: what waits is incomplete."""
    cost: int
    """In nominal microseconds; at least `READ_COST`."""


INCOMPLETE = Piece(0, 0)


def cost_of_bytes(count: int) -> int:
    """Return what plain bytes cost."""
    return READ_COST + count * KIB_COST // 1_024


def cost_of_checking(count: int) -> int:
    """Return what it costs to parse a head or a body and to check it."""
    return READ_COST + min(count, MAX_CHECKED_BYTES) * CHECKED_KIB_COST // 1_024
