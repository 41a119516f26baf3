"""How much lint looks at, so that no file keeps it busy for long."""

MAX_STEPS = 1_000_000
"""Comparisons and systems looked at for one model; four times what 10,000 guarded nodes take."""


class Budget:
    """Steps that are left for one model; where none are, lint takes everything for possible."""

    def __init__(self, steps: int = MAX_STEPS) -> None:
        self._left = steps

    @property
    def is_spent(self) -> bool:
        """Tell whether no steps are left."""
        return self._left <= 0

    def spend(self, steps: int = 1) -> None:
        """Note steps that were taken."""
        self._left -= steps
