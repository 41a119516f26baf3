"""What a core keeps over a restart, gathered from its outputs as storage does."""

from domain.inputs import Restored
from domain.kept import Kept
from domain.outbox import Outputs


class KeptValues:
    """The newest value of each kind and name."""

    def __init__(self) -> None:
        self._values: dict[tuple[type[Kept], str], Kept] = {}

    def take(self, outputs: Outputs) -> Outputs:
        """Keep and forget what outputs say; return them."""
        for item in outputs.kept:
            if item.value is None:
                self._values.pop((item.kind, item.name), None)
            else:
                self._values[item.kind, item.name] = item.value
        return outputs

    def of(self, kind: type[Kept]) -> list[Kept]:
        """Return the values of one kind."""
        return [value for value in self._values.values() if isinstance(value, kind)]

    def restored(self, boot: int = 2, next_event: int = 10_001, next_change: int = 1) -> Restored:
        """Return the first input of the next run."""
        values = tuple(reversed(self._values.values()))
        return Restored(values, boot, next_event=next_event, next_change=next_change)
