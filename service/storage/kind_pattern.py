"""What the kinds of events are that a query asks for."""


class KindPattern:
    """The kinds that a text means: `change.failed`, all of `change`, or `*.failed`.

    A `*` stands for any characters, also none. Without one, a text means the kind itself and the
    kinds below it: `change` means `change.failed`, and `chang` means nothing.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self._below = f"{text}."
        self._first, *self._more = text.split("*")

    def matches(self, kind: str) -> bool:
        """Tell whether a kind is meant, in time that is linear in its length for each `*`."""
        if not self._more:
            return kind == self._text or kind.startswith(self._below)
        if not kind.startswith(self._first):
            return False
        *between, last = self._more
        at = len(self._first)
        for piece in between:
            # The earliest place of each piece leaves the most for those after it.
            found = kind.find(piece, at)
            if found < 0:
                return False
            at = found + len(piece)
        return kind.endswith(last) and at + len(last) <= len(kind)
