"""Which errors are on: by name, what switched, and which of them can have been the first."""

from collections.abc import Mapping

from domain.outbox import Outbox
from domain.snapshot import ErrorKey
from domain.state_and_mode import PartName


class OnErrors:
    """The errors that are on, in the order in which they were raised."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._all: dict[ErrorKey, None] = {}
        self._by_name: dict[str, dict[PartName, None]] = {}
        self._switched: dict[ErrorKey, None] = {}
        self._first_step = 0
        self.contenders: dict[ErrorKey, None] = {}
        """Those that were raised in the step in which the first one was since none was on."""

    def __contains__(self, key: ErrorKey) -> bool:
        """Tell whether an error is on."""
        return key in self._all

    def switch(self, key: ErrorKey, *, on: bool) -> None:
        """Note that an error was raised, or ended."""
        self._switched[key] = None
        if on:
            if not self._all:
                self._first_step, self.contenders = self._outbox.step, {}
            self._all[key] = None
            if self._outbox.step == self._first_step:
                self.contenders[key] = None
        else:
            del self._all[key]
        if key.part is not None:
            parts = self._by_name.setdefault(key.error, {})
            if on:
                parts[key.part] = None
            else:
                del parts[key.part]

    def take_switched(self) -> tuple[ErrorKey, ...]:
        """Return the errors that were raised or ended since the last call, in order."""
        switched, self._switched = self._switched, {}
        return tuple(switched)

    @property
    def oldest(self) -> ErrorKey | None:
        """Return the one that was raised first of those that are on; None: there is none."""
        return next(iter(self._all), None)

    @property
    def is_empty(self) -> bool:
        """Tell whether no error is on."""
        return not self._all

    @property
    def parts_by_name(self) -> Mapping[str, Mapping[PartName, None]]:
        """Return by name the parts that have the error; read only."""
        return self._by_name
