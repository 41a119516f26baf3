"""What a statistic over a window has to answer."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

from domain.timebase import Instant
from domain.windows.contents import Contents
from domain.windows.settings import Threshold


class Measure(ABC):
    """A statistic that is kept up to date as readings enter and leave a window.

    Both cost the same on average, however many readings the window holds.
    """

    @abstractmethod
    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in the newest readings of the window, in their order."""

    @abstractmethod
    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out the oldest readings of the window, in their order."""

    @abstractmethod
    def value(self, contents: Contents, now: Instant) -> float | None:
        """Return the statistic; None: the readings do not have one.

        It is asked only while it is known, see `WindowSettings.min_n`.

        Raises:
            OverflowError: It is beyond any float.
        """

    def crosses_at(
        self, contents: Contents, now: Instant, threshold: Threshold, value: float
    ) -> Instant | None:
        """Return when the statistic may cross a threshold by time alone; None: it does not.

        Args:
            contents: The window; it holds a reading, unless only silence is measured.
            now: The current time.
            threshold: What might be crossed.
            value: The statistic now.
        """
        return contents.leaves_at(0) if len(contents) else None

    def changes_at(self, contents: Contents, now: Instant) -> Instant | None:
        """Return when the statistic may change by time alone; `now`: all the time; None: never."""
        return contents.leaves_at(0) if len(contents) else None
