"""Readings that were rejected, on every way in: counted, and logged."""

import logging
from collections import Counter

from domain.actor import Actor

log = logging.getLogger(__name__)

WAYS = ("http", "websocket", "rosbridge", "ros")
"""Ways in of readings."""


class RefusedReadings:
    """Counts of rejected readings by way; the log of the process limits their lines.

    A message on `/ws` that cannot be read counts as one, since nearly all that clients send there
    are readings.
    """

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()

    def note(self, sender: Actor, why: str) -> None:
        """Count and log a rejected reading.

        Args:
            sender: Who sent it, with the way in.
            why: What is wrong with it; never the message itself, which may hold a token.
        """
        self.counts[sender.way or sender.name] += 1
        log.warning("rejected a reading of %s: %.500s", sender.label, why)

    def note_ignored(self, sender: Actor, what: str) -> None:
        """Log that a stop or hold was taken, and what stood around it was not.

        Args:
            sender: Who sent it.
            what: What was ignored.
        """
        log.warning("took a stop or hold of %s, and ignored: %.500s", sender.label, what)
