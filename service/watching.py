"""How those who hand out values tell their readers that there is something new."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager


class Watched:
    """Something that readers look into at their own pace, woken when it changed.

    A wake-up carries nothing, so that nothing can pile up for a reader that is slow: it looks at
    what there is then.
    """

    def __init__(self) -> None:
        self._wakes: list[Callable[[], None]] = []

    @contextmanager
    def watch(self, wake: Callable[[], None]) -> Iterator[None]:
        """Call `wake` after each change, as long as the context lasts.

        Args:
            wake: Returns at once and raises nothing, like `asyncio.Event.set`.
        """
        self._wakes.append(wake)
        try:
            yield
        finally:
            self._wakes.remove(wake)

    def _wake_watchers(self) -> None:
        for wake in self._wakes:
            wake()
