"""What is drawn: the robot, how good the contact is, and what time it is."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from api.cli.monitor.store import Robot


class Level(StrEnum):
    """How good the contact is."""

    CONNECTING = "connecting"
    """There never was any."""
    LIVE = "live"
    LOST = "lost"


@dataclass(frozen=True, slots=True)
class Contact:
    """How good the contact is, and why."""

    level: Level
    silence_s: float
    """Since the last frame, or since the beginning."""
    why: str = ""
    """Why there is none; empty where there is, or where nobody knows."""


@dataclass(frozen=True, slots=True)
class View:
    """What is drawn at one moment."""

    url: str
    robot: Robot
    contact: Contact
    now_s: float
    """The service's time, in seconds since 1970."""

    def age_s(self, at: str) -> float:
        """Return the seconds since a time of the service; never negative."""
        return max(0.0, self.now_s - seconds_of(at))


def seconds_of(at: str) -> float:
    """Return a time in RFC 3339 as seconds since 1970."""
    return datetime.fromisoformat(at).timestamp()
