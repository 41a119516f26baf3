"""How the sources of signals are doing."""

from dataclasses import dataclass

from domain.timebase import Duration


@dataclass(slots=True)
class SourceStatus:
    """How a source is doing, for metrics and warnings."""

    name: str
    signals: tuple[str, ...]
    reads: int = 0
    """Readings that were accepted."""
    failures: int = 0
    """Readings that could not be had, or were refused."""
    duration: Duration | None = None
    """How long it last took to measure; None: it does not say."""
