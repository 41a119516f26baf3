"""The words of the processes of nodes: what they do, and what is asked of them."""

from dataclasses import dataclass
from enum import StrEnum

from domain.actor import NOBODY, Actor
from domain.state_and_mode import PartName


class RestartPolicy(StrEnum):
    """After which ends a process is started again, apart from those that somebody asked for."""

    ON_FAILURE = "on_failure"
    ALWAYS = "always"
    NEVER = "never"


class ProcessAction(StrEnum):
    """What somebody asks of the process of a node."""

    START = "start"
    STOP = "stop"
    RESTART = "restart"


class ProcessState(StrEnum):
    """How the process of a node stands."""

    NOT_RUN_HERE = "not_run_here"
    """Nothing here runs processes: the nodes are simulated, or this is no live service."""
    STOPPED = "stopped"
    """Somebody asked for its end, also in an earlier run of the service."""
    STARTING = "starting"
    RUNNING = "running"
    STOPPING = "stopping"
    WAITING = "waiting"
    """It ended, and is started again after the back-off."""
    ENDED = "ended"
    """It ended, and `restart` of the robot file leaves it so."""
    GIVEN_UP = "given_up"
    """It ended too often: it is not started again before somebody asks."""


@dataclass(frozen=True, slots=True)
class ProcessExit:
    """How a process ended."""

    code: int | None = None
    """Exit code; None: a signal ended it, or it was never started."""
    signal: str = ""
    """Name of the signal that ended it, such as `SIGSEGV`; empty: none did."""
    reason: str = ""
    """Why it could not be started; empty: it was."""

    @property
    def is_failure(self) -> bool:
        """Tell whether it did not end by itself with exit code 0."""
        return self.code != 0

    @property
    def words(self) -> str:
        """Return how it ended, in words."""
        if self.reason:
            return self.reason
        return f"ended by {self.signal}" if self.signal else f"exit code {self.code}"


@dataclass(frozen=True, slots=True)
class ProcessReport:
    """Whether the process of a node runs; whoever runs it tells each change, and how it begins."""

    node: PartName
    pid: int | None = None
    """None: it does not run."""
    exit: ProcessExit | None = None
    """How it ended just now; None: it runs, or nothing ran yet."""


@dataclass(frozen=True, slots=True)
class ProcessRequest:
    """Start, stop or restart the process of a node; a start makes its whole budget available."""

    node: PartName
    action: ProcessAction
    actor: Actor = NOBODY
