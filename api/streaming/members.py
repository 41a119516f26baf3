"""Text of the members of JSON objects, made once as long as what they show is the same."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Generic, TypeVar

from pydantic_core import to_json

View = TypeVar("View")


class Members(Generic[View]):
    """Members of a JSON object, kept by name; a view that is the same object is not made again.

    So a frame with 10,000 parts of which none changed is little more than joining strings.
    """

    def __init__(self, encode: Callable[[View], str]) -> None:
        self._encode = encode
        self._known: dict[str, tuple[View, str]] = {}

    def text(self, views: Mapping[Any, View]) -> str:
        """Return the object that holds these members."""
        return f"{{{','.join(self._each(views))}}}"

    def new_ones(self, views: Iterable[tuple[str, View]]) -> Iterator[tuple[str, View]]:
        """Yield the members that are not known as they are here."""
        for name, view in views:
            known = self._known.get(name)
            if known is None or known[0] is not view:
                yield name, view

    def learn(self, views: Iterable[tuple[str, View]]) -> None:
        """Encode members and keep their text."""
        for name, view in views:
            self._known[name] = (view, f"{to_json(name).decode()}:{self._encode(view)}")

    def _each(self, views: Mapping[Any, View]) -> Iterator[str]:
        self.learn(self.new_ones(views.items()))
        return (self._known[name][1] for name in views)
