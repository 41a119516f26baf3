"""The content of a picture: the robot, the connection, and the time."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from api.cli.monitor.store import Robot


class Level(StrEnum):
    """State of the connection."""

    CONNECTING = "connecting"
    """No frame was received yet."""
    LIVE = "live"
    LOST = "lost"


@dataclass(frozen=True, slots=True)
class Contact:
    """The connection at one instant."""

    level: Level
    silence_s: float
    """Since the last frame, or since the start."""
    why: str = ""
    """Why there is no connection; empty if there is one, or if the reason is unknown."""


@dataclass(frozen=True, slots=True)
class View:
    """The content of one picture."""

    url: str
    robot: Robot
    contact: Contact
    now_s: float
    """The service's time, in seconds since 1970."""

    def age_s(self, at: str) -> float:
        """Return the seconds since a time of the service; never negative."""
        return max(0.0, self.now_s - seconds_of(at))

    def known_for_s(self, at: str) -> float:
        """Return the seconds from a time of the service until now, or until the last frame.

        Without contact nobody knows whether what began then still lasts.
        """
        newest = self.robot.at
        if self.contact.level is Level.LIVE or newest is None:
            return self.age_s(at)
        return max(0.0, seconds_of(newest) - seconds_of(at))


def seconds_of(at: str) -> float:
    """Return a time in RFC 3339 as seconds since 1970."""
    return datetime.fromisoformat(at).timestamp()
