"""Whether two computers mean the same robot, and the same language."""

from typing import NamedTuple

from domain.link.messages import Terms

DEVICE_CONFLICT = "DEVICE_CONFLICT"
SECOND_SUPERVISOR = "SECOND_SUPERVISOR"
OTHER_PROTOCOL = "OTHER_PROTOCOL"
OTHER_MODEL = "OTHER_MODEL"
OTHER_OWNERSHIP = "OTHER_OWNERSHIP"
UNKNOWN_DEVICE = "UNKNOWN_DEVICE"

OLDEST_PROTOCOL = 1
"""Oldest version that is spoken; the newer of two computers speaks the older one's."""


class Refusal(NamedTuple):
    """Why a process is not dealt with; see `Refused`."""

    code: str
    message: str


def find_refusal(own: Terms, other: Terms) -> Refusal | None:
    """Return why two computers do not fit together; None: they do.

    Args:
        own: Of the computer that judges.
        other: As the other says.
    """
    if other.protocol < OLDEST_PROTOCOL:
        spoken = f"it speaks version {other.protocol} of the protocol"
        return Refusal(OTHER_PROTOCOL, f"{spoken}, {OLDEST_PROTOCOL} is the oldest that is spoken")
    if other.model != own.model:
        return Refusal(OTHER_MODEL, "it runs another model")
    if other.ownership != own.ownership:
        return Refusal(OTHER_OWNERSHIP, "its robot file gives the devices other parts or times")
    return None
