"""Who sent an input, and through which interface."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Actor:
    """The sender of an input: a person or a program.

    Events, holds and the emergency stop show it by its label.
    """

    name: str = ""
    """Name that it gives, or its kind: `service`, `ros`; empty: only the address is known."""
    way: str = ""
    """Interface through which the input came, such as `http` or `rosbridge`."""
    address: str = ""
    """Host of the sender; empty: this process, or a middleware that hides it."""

    @property
    def label(self) -> str:
        """Return the name or else the origin, such as `http:10.0.0.7`; empty: nobody."""
        return self.name or ":".join(filter(None, (self.way, self.address)))


SERVICE = Actor("service")
"""The service itself; whoever comes from outside comes through an interface."""

NOBODY = Actor()
"""Nobody in particular: the robot itself, or time."""
