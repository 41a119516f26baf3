"""Wakes the readers of a value when it changes."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager


class Watched:
    """A value that readers read at their own pace, and that wakes them when it changes.

    A wake-up carries no data, so that nothing queues up for a slow reader: it reads the value that
    is current then.
    """

    def __init__(self) -> None:
        self._wakes: list[Callable[[], None]] = []

    @contextmanager
    def watch(self, wake: Callable[[], None]) -> Iterator[None]:
        """Call `wake` after each change while the context is open.

        Args:
            wake: Must return at once and not raise, as `asyncio.Event.set`.
        """
        self._wakes.append(wake)
        try:
            yield
        finally:
            self._wakes.remove(wake)

    def _wake_watchers(self) -> None:
        for wake in self._wakes:
            wake()
