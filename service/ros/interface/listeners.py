"""Who listens to which topic."""

from collections.abc import Callable
from functools import partial

from service.ros.interface.offer import Fields


class Listeners:
    """Those who want the messages of topics, each as often as it said so."""

    def __init__(self) -> None:
        self._takes: dict[str, dict[object, Callable[[Fields], None]]] = {}

    def add(self, topic: str, take: Callable[[Fields], None]) -> Callable[[], None]:
        """Add a listener, and return what removes it; it may be called more than once."""
        token = object()
        self._takes.setdefault(topic, {})[token] = take
        return partial(self._remove, topic, token)

    def hears(self, topic: str) -> bool:
        """Tell whether anybody listens to a topic."""
        return topic in self._takes

    def send(self, topic: str, message: Fields) -> None:
        """Hand a message to all who listen to its topic."""
        for take in tuple(self._takes.get(topic, {}).values()):
            take(message)

    def _remove(self, topic: str, token: object) -> None:
        takes = self._takes.get(topic, {})
        takes.pop(token, None)
        if not takes:
            self._takes.pop(topic, None)
