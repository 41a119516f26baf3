"""What may put another target than the requested one in force for a part."""

from typing import Protocol

from domain.actor import Actor
from domain.findings import Blocker
from domain.snapshot import Because
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant


class Displacer(Protocol):
    """One rule of a system, one fallback or one reaction of a part."""

    def __hash__(self) -> int:
        """Return what tells it from others of the same kind."""
        ...

    @property
    def because(self) -> Because:
        """Return what kind it is."""
        ...

    @property
    def system(self) -> PartName:
        """Return the part whose target it replaces; those below inherit."""
        ...

    @property
    def name(self) -> str | None:
        """Return its name, unique among those of its kind and part; None: it has none."""
        ...

    @property
    def new_target(self) -> StateAndMode:
        """Return the target that it puts in force."""
        ...

    @property
    def strength(self) -> int:
        """Return who prevails among those of its kind: the greater; of equals, who came later."""
        ...

    @property
    def actor(self) -> Actor:
        """Return in whose name changes begin that lead there and back."""
        ...

    @property
    def relief(self) -> str:
        """Return in words why what it replaced may be in force again."""
        ...

    def cause(self, since: Instant) -> Blocker:
        """Return why its target is in force, as far as that is known without asking anything."""
        ...


def key_of(displacer: Displacer) -> tuple[Because, PartName, str | None, StateAndMode]:
    """Return what identifies a displacer over a restart."""
    return (displacer.because, displacer.system, displacer.name, displacer.new_target)
