"""Watches a vehicle that was stopped, until it stands still."""

import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from api.cli.terminal_line import TerminalLine
from api.client.outcomes import Json, NoAnswerError
from api.terminal_text import say

if TYPE_CHECKING:
    from api.client.bare_request import Answer

LOOK_S = 1.0
"""Longest time for one look at the vehicle, and between two lines on its speed."""
_POLL_S = 0.1
_OLD_S = 1.0
"""What the vehicle reported longer ago says nothing of now."""


class Standstill:
    """Watches a vehicle that was stopped, until it stands still."""

    def __init__(self, ask: Callable[..., "Answer"], latch: Json, *, is_quiet: bool) -> None:
        """Look at nothing yet.

        Args:
            ask: Sends a request: method, path, time limit in s.
            latch: The emergency stop, as answered.
            is_quiet: Do not tell the speed, except on a terminal.
        """
        self.latch = latch
        """The emergency stop, as of the last look."""
        self.speed_mps: float | None = None
        """As last reported; None: that is not known."""
        self._ask = ask
        self._is_quiet = is_quiet
        self._why = ""
        self._at: str | None = None
        self._reported_s = 0.0

    @property
    def is_engaged(self) -> bool:
        """Tell whether the stop is still engaged, as far as that is known."""
        return self.latch.get("engaged") is True

    @property
    def is_still(self) -> bool | None:
        """Tell whether the vehicle stands still; None: that is not known."""
        if self.latch.get("standstill_at") is not None:
            return True
        return None if self.speed_mps is None else False

    def wait(self, within_s: float) -> None:
        """Look again and again, until the vehicle stands still or the time is over."""
        begin = time.monotonic()
        told_s = begin
        with TerminalLine(sys.stderr) as line:
            while True:
                self._look()
                now_s = time.monotonic()
                if self.is_still or not self.is_engaged or now_s >= begin + within_s:
                    return
                if line.is_shown:
                    line.show(self._speed_words())
                elif not self._is_quiet and now_s >= told_s + LOOK_S:
                    told_s = now_s
                    say(self._speed_words())
                time.sleep(_POLL_S)

    def words(self) -> str:
        """Return whether the vehicle stands still, in words."""
        if not self.is_engaged:
            return "somebody has released the stop meanwhile"
        if self.is_still:
            return "the vehicle stands still"
        if self.is_still is None:
            return f"it is not known whether the vehicle stands still: {self._why}"
        return f"the vehicle still moves at {self._speed_words()}: use the hardware stop"

    def _speed_words(self) -> str:
        if self.speed_mps is None:
            return f"its speed is not known: {self._why}"
        return f"{abs(self.speed_mps):.2f} m/s"

    def _look(self) -> None:
        try:
            latch = self._ask("GET", "/emergency_stop", LOOK_S)
            vehicle = self._ask("GET", "/vehicle", LOOK_S)
        except NoAnswerError as error:
            self.speed_mps, self._why = None, str(error)
            return
        if "standstill_at" in latch.body:
            self.latch = latch.body
        self._take_vehicle(vehicle.body)

    def _take_vehicle(self, vehicle: Json) -> None:
        """Take a report of the vehicle; its age is by our own clock, since it has another one."""
        at, now_s = vehicle.get("at"), time.monotonic()
        if at != self._at:
            self._at, self._reported_s = at, now_s
        if at is None or now_s - self._reported_s > _OLD_S:
            self.speed_mps, self._why = None, "the vehicle does not report"
        else:
            self.speed_mps = vehicle.get("speed_mps")
