"""The process of a node as clients see it."""

from dataclasses import dataclass

from domain.process_terms import ProcessExit, ProcessState
from domain.state_and_mode import PartName
from domain.timebase import Instant


@dataclass(frozen=True, slots=True)
class ProcessView:
    """The process of a node at one moment."""

    node: PartName
    state: ProcessState
    pid: int | None
    """None: it does not run."""
    since: Instant | None
    """When it began to run; None: it does not."""
    next_start: Instant | None
    """When it is started again; None: nothing is planned."""
    starts_left: int
    """How often it may still be started within the time of the budget."""
    exit: ProcessExit | None
    """How it ended last; None: it did not since the service runs."""
    exit_at: Instant | None
