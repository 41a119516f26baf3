"""The windows over one signal, which take each of its readings once."""

from domain.timebase import Duration, Instant
from domain.windows.settings import WindowSettings
from domain.windows.span import Span
from domain.windows.window import Window, size_of


class SharedWindows:
    """Windows over the same readings; those that hold the same share what they hold."""

    def __init__(self, start: Instant) -> None:
        """Begin without windows.

        Args:
            start: Since when readings would have been heard.
        """
        self._start = start
        self._spans: dict[tuple[Duration | None, int], Span] = {}
        self._windows: dict[WindowSettings, Window] = {}

    def window(self, settings: WindowSettings) -> Window:
        """Return a window, the same for equal settings; there are no readings yet."""
        if settings not in self._windows:
            length, size = settings.length, size_of(settings)
            span = self._spans.setdefault((length, size), Span(length, size, self._start))
            self._windows[settings] = Window(settings, self._start, span)
        return self._windows[settings]

    def add(self, at: Instant, value: float) -> None:
        """Take in a reading, as `Window.add` does."""
        for span in self._spans.values():
            span.add(at, value)
