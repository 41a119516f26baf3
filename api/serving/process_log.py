"""The log of the service on standard error: limited, one line per message, without the token.

Each call site of a log call is a kind of message, and has a limit of its own: a flood of one kind
neither fills the disk nor hides another. Modules therefore log plainly, with what differs (such as
the address of a client) as arguments.
"""

import json
import logging
import re
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias
from urllib.parse import quote, quote_plus

from api.serving.output import Output

INTERVAL_S = 10.0
MAX_RECORDS = 20
"""Records of one kind in an interval; those beyond are counted, and told at its end."""
TRACEBACK_COST = 5
"""A record with a traceback counts as so many."""
MAX_CHARACTERS = 2_000
"""Of one message."""

_MAX_TEXT = 20_000
"""Characters of one record with its traceback."""
_OURS = ("api", "service", "domain", "web")
_HIDDEN = "[token]"
_LEAST_SECRET = 4
"""A shorter text is in half of all lines."""
_BEARER = re.compile(r"(?i)(bearer[\s:=]+)[^\s'\",)]+")
# Also those that reorder text on a terminal, and halves of a surrogate pair.
_CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")

Site: TypeAlias = tuple[str, int]
"""File and line of a log call."""


@dataclass(slots=True)
class _Spent:
    """What one kind has used of its limit."""

    until_s: float
    records: int = 0
    untold: int = 0
    last: logging.LogRecord | None = None


class LineLimit:
    """Counts the records of each call site."""

    def __init__(self) -> None:
        self._spent: dict[Site, _Spent] = {}

    def admits(self, record: logging.LogRecord, now_s: float) -> bool:
        """Tell whether a record is written; one that is not is counted.

        Args:
            record: What somebody logs; critical ones are always written.
            now_s: Monotonic time, s.
        """
        if record.levelno >= logging.CRITICAL:
            return True
        site = (record.pathname, record.lineno)
        spent = self._spent.setdefault(site, _Spent(now_s + INTERVAL_S))
        if spent.records >= MAX_RECORDS:
            spent.untold += 1
            spent.last = record
            return False
        spent.records += TRACEBACK_COST if record.exc_info else 1
        return True

    def ended(self, now_s: float) -> list[tuple[logging.LogRecord, int]]:
        """Forget the intervals that are over; return the last record and the count of each flood.

        Args:
            now_s: Monotonic time, s; infinite: all are over.
        """
        over = [site for site, spent in self._spent.items() if spent.until_s <= now_s]
        gone = [self._spent.pop(site) for site in over]
        return [(spent.last, spent.untold) for spent in gone if spent.last is not None]


class LineFormat(logging.Formatter):
    """Formats a record as one line, and hides secrets."""

    def __init__(self, token: str | None) -> None:
        """Prepare.

        Args:
            token: Of the service, which no line may hold; None: there is none.
        """
        super().__init__("%(asctime)s %(levelname)s %(name)s: %(message)s")
        self._hide = _hiding(token)

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802  # of the base class
        """Make one line of the message, whatever a client put into it."""
        # Hidden before it is cut: half a token is a secret too.
        message = self._hide(record.message.strip())
        record.message = _CONTROL.sub(_escaped, message[:MAX_CHARACTERS])
        return super().formatMessage(record)

    def format(self, record: logging.LogRecord) -> str:
        """Return the line, followed by the traceback if there is one."""
        return self._hide(super().format(record))[:_MAX_TEXT]


class LimitedHandler(logging.Handler):
    """Writes records within their limits; never blocks, and never raises."""

    def __init__(
        self, write: Callable[[str], None], read_clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Prepare.

        Args:
            write: Takes a text and returns at once.
            read_clock: Returns monotonic time, s.
        """
        super().__init__()
        self._write = write
        self._read_clock = read_clock
        self._limit = LineLimit()
        self._timer: threading.Timer | None = None

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record, or count it."""
        now_s = self._read_clock()
        self._tell_ended(now_s)
        if self._limit.admits(record, now_s):
            self._put(record)
        elif self._timer is None:
            # The flood may be the last that is logged for hours.
            self._timer = threading.Timer(INTERVAL_S, self._ring)
            self._timer.daemon = True
            self._timer.start()

    def close(self) -> None:
        """Write the counts of what was not written."""
        with self.lock or threading.RLock():
            self._tell_ended(float("inf"))
        super().close()

    def _ring(self) -> None:
        with self.lock or threading.RLock():
            self._timer = None
            self._tell_ended(self._read_clock())

    def _tell_ended(self, now_s: float) -> None:
        for last, count in self._limit.ended(now_s):
            words = f"and {count} more like this, the last: {last.getMessage()}"
            self._put(logging.LogRecord(last.name, last.levelno, "", 0, words, None, None))

    def _put(self, record: logging.LogRecord) -> None:
        try:
            text = self.format(record)
        except Exception as error:
            # The edge to whoever logs: an argument that does not fit is a bug that ends nothing.
            text = f"{record.pathname}:{record.lineno}: a record cannot be written: {error!r}"
        self._write(f"{text}\n")


def log_to(output: Output, level: str, token: str | None) -> None:
    """Write the log of this process to an output from now on.

    Of other libraries only warnings and errors are logged, at every level: what they say at
    `debug`, such as the headers of a handshake, holds secrets.

    Args:
        output: Where to.
        level: The least level of our own modules: `debug`, `info`, `warning` or `error`.
        token: Of the service.
    """
    handler = LimitedHandler(output.write)
    handler.setFormatter(LineFormat(token))
    handler.addFilter(is_for_operators)
    logging.basicConfig(level=level.upper(), handlers=[handler])


def is_for_operators(record: logging.LogRecord) -> bool:
    """Tell whether a record is ours, or a warning or an error of a library."""
    return record.levelno >= logging.WARNING or record.name.partition(".")[0] in _OURS


def _hiding(token: str | None) -> Callable[[str], str]:
    """Return what hides the token, in each way in which it may be written, and those of others."""
    if token is None or len(token) < _LEAST_SECRET:
        return lambda text: _BEARER.sub(rf"\1{_HIDDEN}", text)
    written = {token, repr(token)[1:-1], json.dumps(token)[1:-1], quote(token), quote_plus(token)}
    ways = re.compile("|".join(map(re.escape, sorted(written, key=len, reverse=True))))
    return lambda text: ways.sub(_HIDDEN, _BEARER.sub(rf"\1{_HIDDEN}", text))


def _escaped(found: re.Match[str]) -> str:
    return found[0].encode("unicode_escape").decode("ascii")
