"""Who asked for something, and how that is known."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Actor:
    """Somebody, or something, that hands in an input.

    Events, holds and the emergency stop show it by its label.
    """

    name: str = ""
    """What it calls itself, or is: `service`, `ros`; empty: it is known by its address alone."""
    way: str = ""
    """The interface by which it came, such as `http` or `rosbridge`."""
    address: str = ""
    """Host from which it came; empty: from this process, or by a middleware that hides it."""

    @property
    def label(self) -> str:
        """Return its name, or else where it came from: `http:10.0.0.7`; empty: nobody."""
        return self.name or ":".join(filter(None, (self.way, self.address)))


NOBODY = Actor()
"""Nobody in particular: the robot itself, or time."""
