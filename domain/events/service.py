"""Events of the service itself: writes, restarts, stalls and time."""

from dataclasses import dataclass

from domain.events.event import Event, because


@dataclass(frozen=True, slots=True)
class WriteAnswered(Event):
    """A write request was answered, or a reading released a stop; the audit trail."""

    kind = "audit.write"
    is_input = True
    is_notable = False

    method: str
    """Of HTTP, or CALL of a ROS service, or READING that releases a stop."""
    path: str
    """Of the request, or name of the service."""
    status: int
    """HTTP status code, also of calls and readings."""
    address: str
    """Host and port of the client, as far as known; else its name."""

    def _words(self) -> str:
        return f"{self.method} {self.path} from {self.address} answered {self.status}"


@dataclass(frozen=True, slots=True)
class ServiceRestored(Event):
    """The service runs again, with what an earlier run of it left.

    Nothing that is restored starts anything: a task is held, and parts wait for a request.
    """

    kind = "service.restored"
    is_input = True

    boot: int
    """Number of this run, from 1."""
    targets: int
    """Requests whose targets are in force again."""
    changes: int
    """Changes that had not ended; they failed."""
    tasks: int
    """Tasks that had not ended; they are held."""
    holds: int
    errors: int
    """Errors that an operator has yet to acknowledge."""
    emergency_stop: bool
    """Whether the emergency stop is engaged."""
    reason: str
    """Why it is, whatever was kept; empty: it is as it was kept."""

    def _words(self) -> str:
        told = [
            _counted(self.targets, "requested target"),
            _counted(self.changes, "change", " failed"),
            _counted(self.tasks, "task", " held"),
            _counted(self.holds, "hold"),
            _counted(self.errors, "error", " to acknowledge"),
            because("emergency stop engaged", self.reason) if self.emergency_stop else "",
        ]
        what = ", ".join(filter(None, told)) or "nothing was kept"
        return f"restored after a restart: {what}"


@dataclass(frozen=True, slots=True)
class NotRestored(Event):
    """Something that was kept is not restored, for a reason, and is no longer kept."""

    kind = "service.not_restored"

    what: str
    reason: str

    def _words(self) -> str:
        return because(f"{self.what} is not restored", self.reason)


@dataclass(frozen=True, slots=True)
class ServiceStalled(Event):
    """The service itself did nothing for a while, such as on a host that is too busy.

    What arrived meanwhile was taken in before ages and deadlines were judged. Told at most once in
    10 s, with the longest stall.
    """

    kind = "service.stalled"
    is_input = True

    late_s: float

    def _words(self) -> str:
        return f"the service itself was {self.late_s:.2f} s late"


@dataclass(frozen=True, slots=True)
class TimeWasDue(Event):
    """A deadline passed, or something has been stale or bad for long enough."""

    kind = "time.passed"
    is_input = True
    is_notable = False

    def _words(self) -> str:
        return "a deadline passed"


@dataclass(frozen=True, slots=True)
class StorageDegraded(Event):
    """What happens cannot be written down: a restart may forget what is asked from now on."""

    kind = "storage.degraded"
    is_input = True

    reason: str

    def _words(self) -> str:
        return f"storage fails: {self.reason}"


@dataclass(frozen=True, slots=True)
class StorageRecovered(Event):
    """What happens is written down again, and what is kept is on disk."""

    kind = "storage.recovered"
    is_input = True

    def _words(self) -> str:
        return "storage works again"


@dataclass(frozen=True, slots=True)
class GraphFaultFound(Event):
    """Something is wrong in the ROS graph: messages do not come, or two nodes have one name."""

    kind = "ros.fault"
    is_input = True

    fault: str
    """`qos`: incompatible quality of service; `type`: another message type; `duplicate`: two nodes
    of one name."""
    name: str
    """Full name of the topic, or of the node."""
    reason: str

    def _words(self) -> str:
        return f"{self.name}: {self.reason}"


@dataclass(frozen=True, slots=True)
class GraphFaultEnded(Event):
    """Something that was wrong in the ROS graph is right again."""

    kind = "ros.fault_ended"
    is_input = True

    fault: str
    """As in `ros.fault`."""
    name: str
    """As in `ros.fault`."""

    def _words(self) -> str:
        return f"{self.name} is right again in the ROS graph"


def _counted(count: int, noun: str, more: str = "") -> str:
    """Return such as `2 holds`; empty: there are none."""
    return f"{count} {noun}{'' if count == 1 else 's'}{more}" if count else ""
