"""Which parts wait for an operator after a restart of the service."""

from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName


class WaitingParts:
    """None at first; all parts after a restart, until something is requested of each.

    Who restarts the service may not expect a robot to move by itself, and whoever stands next to it
    even less.
    """

    def __init__(self, model: SmhModel) -> None:
        self._model = model
        self._after_restart = False
        self._requested: set[PartName] = set()
        """Parts of which something was requested since; those below them are not listed."""

    def begin(self) -> None:
        """Let all parts wait."""
        self._after_restart = True

    def end(self, part: PartName) -> None:
        """Let a part, and those below it, wait no more."""
        if self._after_restart:
            self._requested.add(part)

    def includes(self, part: PartName) -> bool:
        """Tell whether a part waits."""
        if not self._after_restart or part in self._requested:
            return False
        return self._requested.isdisjoint(self._model.ancestors[part])
