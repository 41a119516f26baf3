"""The limits for clients of the service."""

from dataclasses import dataclass
from typing import Self

from service.files.limits_block import KIB, MIB, LimitsBlock


@dataclass(frozen=True, slots=True)
class ServiceLimits:
    """Limits for bodies and messages, bytes, and for the number of clients and requests."""

    json_bytes: int = 256 * KIB
    """Parsed on the event loop in about 8 ms for waypoints."""
    model_bytes: int = 8 * MIB
    """Of bodies that only the worker parses."""
    waypoints_bytes: int = 16 * MIB
    """Enough for 100,000 waypoints as JSON with all digits."""
    message_bytes: int = 64 * KIB
    """Of a message that a client sends over the WebSocket."""
    stream_clients: int = 2_500
    requests_per_s: int = 1_000
    """Of one client address; short bursts of twice as many are allowed."""

    @classmethod
    def of(cls, block: LimitsBlock) -> Self:
        """Return the limits that a robot file sets."""
        return cls(**block.model_dump())


USUAL_LIMITS = ServiceLimits()
