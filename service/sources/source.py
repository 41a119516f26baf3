"""The port of sources; `tests/conformance/test_source.py` specifies what an adapter must do."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from domain.timebase import Duration, Instant

_LONGEST = 200


class SourceError(Exception):
    """Why a source gives no reading, in words for an operator."""


class Sink(Protocol):
    """Takes what a source has to say; called on the thread of the event loop.

    A value may be anything: one that its signal cannot have is refused, and counts as a failure.
    """

    def take(self, signal: str, value: object, stamp: Instant | None = None) -> None:
        """Take a reading.

        Args:
            signal: One of the source's.
            value: What was measured: a number, or 1 and 0 for true and false.
            stamp: When, by our clock; None: now.
        """
        ...

    def fail(self, signal: str, why: str) -> None:
        """Take why there is no reading of a signal now; what lasts is told again and again."""
        ...

    def note_duration(self, duration: Duration) -> None:
        """Take how long the source needed to measure."""
        ...


class Source(Protocol):
    """Turns one thing into readings of one or more signals.

    It may ask for values, or pass on those that it is given, as a callback of ROS 2 does.
    """

    @property
    def name(self) -> str:
        """Return its name: that of the readings' source, in the log and in metrics."""
        ...

    @property
    def signals(self) -> tuple[str, ...]:
        """Return the signals that it reads."""
        ...

    async def run(self, sink: Sink) -> None:
        """Give readings until cancelled.

        What it raises is the reason why all its signals have no reading; it is run again later. It
        must neither block the loop nor keep it from ending.
        """
        ...


def reason_of(error: BaseException) -> str:
    """Return what an error says, in a line of limited length."""
    if isinstance(error, OSError) and error.strerror:
        where = f" ({error.filename})" if error.filename else ""
        text = f"{error.strerror}{where}"
    else:
        text = str(error) or type(error).__name__
    return " ".join(text.split())[:_LONGEST]


@contextmanager
def from_extra(extra: str) -> Iterator[None]:
    """Import an optional library in this context.

    Args:
        extra: The extra of this package that installs it.

    Raises:
        SourceError: It is not installed, or does not work on this machine.
    """
    try:
        yield
    except ImportError as error:
        raise SourceError(f"{error}: pip install 'pilothouse[{extra}]'") from error
