"""What the monitor knows at this moment, and how good its contact is."""

import time
from collections.abc import Callable

from api.cli.monitor.store import Json, Robot, fold
from api.cli.monitor.view import Contact, Level, View, seconds_of
from api.client.server_clock import ServerClock

LOST_S = 3.0
"""Frames come many times a second; after such a silence there is no contact."""

_BEGAN_S = time.time() - time.monotonic()


def local_now() -> float:
    """Return local time that never jumps, in seconds since 1970."""
    return _BEGAN_S + time.monotonic()


class Watch:
    """Takes what comes from a service, and tells what there is to draw."""

    def __init__(
        self,
        url: str,
        news: Callable[[], None] = lambda: None,
        now: Callable[[], float] = local_now,
    ) -> None:
        """Begin without knowing anything.

        Args:
            url: Of the service.
            news: Called after each `state` frame, which what came before it fits, and with the loss
                of contact.
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

    def take(self, message: Json) -> None:
        """Take a frame of the stream, or an answer in its form."""
        self.robot = fold(self.robot, message)
        if message["type"] == "state":
            now_s = self._now()
            self._clock.observe(seconds_of(message["at"]), now_s)
            self._heard_s, self._was_heard = now_s, True
            self._is_connected, self._why = True, ""
            self._news()

    def lose(self, why: str) -> None:
        """Take that the contact is lost, or that there is none.

        Args:
            why: In words.
        """
        self._is_connected, self._why = False, why
        self._news()

    def contact(self) -> Contact:
        """Return how good the contact is."""
        silence_s = self._now() - self._heard_s
        if self._is_connected and silence_s <= LOST_S:
            return Contact(Level.LIVE, silence_s)
        if self._was_heard or silence_s > LOST_S:
            return Contact(Level.LOST, silence_s, self._why)
        return Contact(Level.CONNECTING, silence_s, self._why)

    def view(self) -> View:
        """Return what is to be drawn now."""
        return View(self._url, self.robot, self.contact(), self._clock.at(self._now()))
