"""The current state of the robot and of the connection, for the monitor."""

import time
from collections.abc import Callable
from math import inf, isfinite

from api.cli.monitor.store import Json, Robot, fold
from api.cli.monitor.view import Contact, Level, View, seconds_of

LOST_S = 3.0
"""Frames come many times a second; after this silence, s, the connection counts as lost."""

_CLOCK_WINDOW_S = 10.0
_OF_NOW = ("state", "graph")
"""Frames that tell how the robot is now."""

_BEGAN_S = time.time() - time.monotonic()


def local_now() -> float:
    """Return local time that never jumps, in seconds since 1970."""
    return _BEGAN_S + time.monotonic()


class Watch:
    """Takes the frames of a service, and provides the content of pictures."""

    def __init__(
        self,
        url: str,
        news: Callable[[], None] = lambda: None,
        now: Callable[[], float] = local_now,
    ) -> None:
        """Start without any known state.

        Args:
            url: Of the service.
            news: Called after each `state` frame, and when the connection is lost.
            now: Local time that never jumps, in seconds since 1970.
        """
        self.robot = Robot()
        self._url = url
        self._news = news
        self._now = now
        self._clock = ServerClock()
        self._heard_s = now()
        self._was_heard = False
        self._is_connected = False
        self._why = ""

    def take(self, frame: Json) -> None:
        """Take a frame of the stream."""
        self.robot = fold(self.robot, frame)
        if frame["type"] in _OF_NOW:
            now_s = self._now()
            self._clock.observe(seconds_of(frame["at"]), now_s)
            self._heard_s, self._was_heard = now_s, True
            self._is_connected, self._why = True, ""
            self._news()

    def lose(self, why: str) -> None:
        """Handle that the connection was lost, or cannot be made.

        Args:
            why: The reason, for the user.
        """
        self._is_connected, self._why = False, why
        self._news()

    def contact(self) -> Contact:
        """Return the state of the connection."""
        silence_s = self._now() - self._heard_s
        if self._is_connected and silence_s <= LOST_S:
            return Contact(Level.LIVE, silence_s)
        if self._was_heard or silence_s > LOST_S:
            return Contact(Level.LOST, silence_s, self._why)
        return Contact(Level.CONNECTING, silence_s, self._why)

    def view(self) -> View:
        """Return the content of a picture of now."""
        return View(self._url, self.robot, self.contact(), self._clock.at(self._now()))


class ServerClock:
    """Estimates the offset between our clock and the service's from the times in its frames.

    Transmission can only delay a frame, so the smallest offset of the last 10 to 20 s is the most
    accurate. Older ones are dropped, since either clock may be set.
    """

    def __init__(self) -> None:
        self._window_start_s = -inf
        self._smallest_s = inf
        self._smallest_before_s = inf

    def observe(self, server_s: float, local_s: float) -> None:
        """Take the time of a frame.

        Args:
            server_s: Time in the frame, in seconds since 1970.
            local_s: Time of its arrival, in seconds since 1970.
        """
        if local_s - self._window_start_s > _CLOCK_WINDOW_S:
            self._smallest_before_s, self._smallest_s = self._smallest_s, inf
            self._window_start_s = local_s
        self._smallest_s = min(self._smallest_s, local_s - server_s)

    def at(self, local_s: float) -> float:
        """Return the service's time, in seconds since 1970; before the first frame our own."""
        offset_s = min(self._smallest_s, self._smallest_before_s)
        return local_s - offset_s if isfinite(offset_s) else local_s
