"""Names of parts and modes, and the pair of lifecycle state and mode."""

from dataclasses import dataclass
from typing import NewType

from domain.lifecycle import LifecycleState

PartName = NewType("PartName", str)
"""Name of a system or a node, without a leading slash; may hold slashes (`left/arm`)."""

ModeName = NewType("ModeName", str)

DEFAULT_MODE = ModeName("__DEFAULT__")


def part_name(name: str) -> PartName:
    """Return the name of a part without the leading slash of ROS 2."""
    return PartName(name.lstrip("/"))


@dataclass(frozen=True, slots=True)
class StateAndMode:
    """A lifecycle state and, if any, a mode."""

    state: LifecycleState
    mode: ModeName | None = None

    @property
    def label(self) -> str:
        """Return `active.FAST`, or the state alone if there is no mode."""
        return f"{self.state}.{self.mode}" if self.mode else str(self.state)

    @classmethod
    def parse(cls, label: str) -> "StateAndMode":
        """Read `active.FAST` or `inactive`; a mode is kept only with `active` and `activating`.

        Raises:
            ValueError: The text before the first dot is not the label of a lifecycle state.
        """
        text, _, mode = label.partition(".")
        state = LifecycleState(text)
        has_mode = state in (LifecycleState.ACTIVE, LifecycleState.ACTIVATING)
        return cls(state, ModeName(mode) if mode and has_mode else None)

    def agrees_with(self, other: "StateAndMode") -> bool:
        """Tell whether both mean the same; only `active` has modes, and None is `__DEFAULT__`."""
        if self.state is not other.state:
            return False
        return self.state is not LifecycleState.ACTIVE or (self.mode or DEFAULT_MODE) == (
            other.mode or DEFAULT_MODE
        )
