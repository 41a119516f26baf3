"""Since when parts deviate from their targets."""

from domain.parts.mode_inference import ModeInference
from domain.state_and_mode import PartName
from domain.timebase import Instant


class Deviations:
    """Parts that have not converged, with the instant at which that began."""

    def __init__(self, inference: ModeInference) -> None:
        self._inference = inference
        self._since: dict[PartName, Instant] = {}

    def look(self, part: PartName, now: Instant) -> bool | None:
        """Compare a part and its parts with their targets.

        Returns:
            True: a deviation began; False: it ended; None: no change.
        """
        deviates = not self._inference.converged(part)
        if deviates is (part in self._since):
            return None
        if deviates:
            self._since[part] = now
        else:
            del self._since[part]
        return deviates

    def since(self, part: PartName) -> Instant | None:
        """Return since when a part deviates; None: it does not deviate."""
        return self._since.get(part)
