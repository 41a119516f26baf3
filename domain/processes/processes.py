"""The processes of nodes as a concern: it starts, restarts and gives them up."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from domain.commands import StartProcess, StopProcess
from domain.concern import Concern, Takers
from domain.errors import ProcessElsewhereError, UnknownPartError, UnknownProcessError
from domain.events.event import Event
from domain.events.processes import (
    ProcessEnded,
    ProcessGivenUp,
    ProcessReady,
    ProcessRequested,
    ProcessStarted,
    ProcessWaits,
)
from domain.health.built_in_errors import PROCESS_ENDED, PROCESS_GIVEN_UP
from domain.health.error_list import Found
from domain.health.part_errors import PartErrors
from domain.inputs import Restored
from domain.kept import KeptProcess
from domain.outbox import Outbox
from domain.process_terms import (
    ProcessAction,
    ProcessExit,
    ProcessReport,
    ProcessRequest,
    ProcessState,
    RestartPolicy,
)
from domain.processes.process_view import ProcessView
from domain.processes.settings import ProcessSettings
from domain.processes.start_budget import StartBudget
from domain.snapshot import ErrorState
from domain.state_and_mode import PartName
from domain.timebase import Duration, Instant, seconds, to_seconds

SETTLED_AFTER = seconds(1)
"""How long a process must run before PROCESS_ENDED clears: one that ends at once would flicker."""


@dataclass(slots=True)
class _Process:
    """The process of one node."""

    settings: ProcessSettings
    budget: StartBudget
    state: ProcessState = ProcessState.NOT_RUN_HERE
    is_wanted: bool = True
    """Whether nobody asked for its end."""
    pid: int | None = None
    since: Instant | None = None
    exit: ProcessExit | None = None
    exit_at: Instant | None = None
    back_off: Duration = 0
    """The last one; 0: none since it ran well."""
    given_up: str = ""
    """As in `KeptProcess`."""
    due: Instant | None = None
    """When it is started again, or when it has run long enough; None: neither is awaited."""
    kept: KeptProcess | None = None
    """What is kept of it; None: nothing is."""
    told: dict[str, str] = field(default_factory=dict)
    """Its errors that are on, with their messages."""


class Processes(Concern):
    """Decides when the processes of nodes run.

    Each runs from the start, unless somebody stopped it or it was given up, also in an earlier run
    of the service. One that ends unasked is an error of its node.
    """

    def __init__(
        self,
        settings: Mapping[PartName, ProcessSettings],
        nodes: Iterable[PartName],
        errors: PartErrors,
        outbox: Outbox,
    ) -> None:
        self._nodes = tuple(nodes)
        self._errors = errors
        self._outbox = outbox
        self._processes = {
            node: _Process(own, StartBudget(own.starts, own.within))
            for node, own in settings.items()
        }

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {
            Restored: self.take_restored,
            ProcessReport: self.take_report,
            ProcessRequest: self.take_request,
        }

    # --- what happens ----------------------------------------------------------------------------

    def take_restored(self, restored: Restored, now: Instant) -> None:
        """Bring back who was stopped or given up, and how often each was started."""
        for kept in restored.kept:
            if not isinstance(kept, KeptProcess):
                continue
            own = self._processes.get(kept.node)
            if own is None:
                self._outbox.forget(KeptProcess, kept.name)
                continue
            own.kept = kept
            own.is_wanted, own.given_up = not kept.is_stopped, kept.given_up
            own.budget.restore(kept.ages, now)
            if own.given_up:
                self._set_error(kept.node, own, PROCESS_GIVEN_UP, own.given_up, now)

    def take_report(self, report: ProcessReport, now: Instant) -> None:
        """Note that a process runs or ended, and decide what follows.

        Raises:
            UnknownPartError: The model has no such node.
            UnknownProcessError: It has no process.
        """
        node, own = report.node, self._require(report.node)
        self._outbox.begin(now, _described(report))
        self._outbox.record_input()
        if report.pid is not None:
            self._note_run(node, own, report.pid, now)
        elif report.exit is not None:
            self._note_end(node, own, report.exit, now)
        elif own.given_up:
            own.state = ProcessState.GIVEN_UP
        elif own.is_wanted:
            self._start(node, own, now)
        else:
            own.state = ProcessState.STOPPED
        self._keep(node, own, now)

    def take_request(self, request: ProcessRequest, now: Instant) -> None:
        """Start, stop or restart a process.

        Raises:
            UnknownPartError: The model has no such node.
            UnknownProcessError: It has no process.
            ProcessElsewhereError: Nothing here runs processes.
        """
        node, own = request.node, self._require(request.node)
        if own.state is ProcessState.NOT_RUN_HERE:
            raise ProcessElsewhereError(node)
        self._outbox.begin(now, ProcessRequested(node, request.action), request.actor)
        self._outbox.record_input()
        own.is_wanted = request.action is not ProcessAction.STOP
        own.given_up, own.back_off = "", 0
        runs = own.state in (ProcessState.STARTING, ProcessState.RUNNING)
        if own.is_wanted:
            own.budget.refill()
        if runs and request.action is not ProcessAction.START:
            own.state, own.due = ProcessState.STOPPING, None
            self._outbox.command(StopProcess(node))
        elif own.state is not ProcessState.STOPPING and not runs:
            self._take_while_at_rest(node, own, now)
        self._keep(node, own, now)

    def wake_at(self) -> Instant | None:
        """Return when a process is started again, has run long enough, or may start more often."""
        due = None
        for own in self._processes.values():
            for at in (own.due, own.budget.wake_at()):
                if at is not None and (due is None or at < due):
                    due = at
        return due

    def pass_time(self, now: Instant) -> None:
        """Start what is due, and clear the errors of what has run long enough."""
        for node, own in self._processes.items():
            frees = own.budget.wake_at()
            if frees is not None and frees <= now:
                own.budget.pass_time(now)
                self._keep(node, own, now)
            if own.due is None or own.due > now:
                continue
            own.due = None
            if own.state is ProcessState.WAITING:
                self._start(node, own, now)
                self._keep(node, own, now)
            else:
                self._set_error(node, own, PROCESS_ENDED, "", now)

    # --- what can be seen ------------------------------------------------------------------------

    def view(self, node: PartName) -> ProcessView:
        """Return the process of a node.

        Raises:
            UnknownPartError: The model has no such node.
            UnknownProcessError: It has no process.
        """
        own = self._require(node)
        waits = own.state is ProcessState.WAITING
        return ProcessView(
            node,
            own.state,
            own.pid,
            own.since,
            own.due if waits else None,
            own.budget.left(),
            own.exit,
            own.exit_at,
        )

    # --- inside ----------------------------------------------------------------------------------

    def _require(self, node: PartName) -> _Process:
        if node not in self._nodes:
            raise UnknownPartError("node", node, self._nodes)
        if node not in self._processes:
            raise UnknownProcessError(node, tuple(self._processes))
        return self._processes[node]

    def _start(self, node: PartName, own: _Process, now: Instant) -> None:
        own.state = ProcessState.STARTING
        own.budget.note(now)
        self._outbox.command(StartProcess(node))

    def _take_while_at_rest(self, node: PartName, own: _Process, now: Instant) -> None:
        """Do what is asked of a process that does not run: start it, or leave it alone."""
        own.due = None
        self._set_error(node, own, PROCESS_GIVEN_UP, "", now)
        if own.is_wanted:
            self._start(node, own, now)
        else:
            own.state = ProcessState.STOPPED
            self._set_error(node, own, PROCESS_ENDED, "", now)

    def _note_run(self, node: PartName, own: _Process, pid: int, now: Instant) -> None:
        own.pid, own.since = pid, now
        if own.state is not ProcessState.STOPPING:
            own.state = ProcessState.RUNNING
            own.due = now + SETTLED_AFTER

    def _note_end(self, node: PartName, own: _Process, end: ProcessExit, now: Instant) -> None:
        ran = 0 if own.since is None else now - own.since
        was_asked = own.state is ProcessState.STOPPING
        own.pid = own.since = own.due = None
        own.exit, own.exit_at = end, now
        if was_asked:
            self._take_while_at_rest(node, own, now)
            return
        policy = own.settings.restart
        if policy is RestartPolicy.NEVER or not (end.is_failure or policy is RestartPolicy.ALWAYS):
            own.state = ProcessState.ENDED
        elif own.budget.left() == 0:
            self._give_up(node, own, end, now)
            return
        else:
            self._wait(node, own, ran, now)
        self._set_error(node, own, PROCESS_ENDED, _ended(node, end), now)

    def _wait(self, node: PartName, own: _Process, ran: Duration, now: Instant) -> None:
        """Plan the next start: later each time, unless the process has run well meanwhile."""
        first, most = own.settings.first_back_off, own.settings.most_back_off
        own.back_off = first if not own.back_off or ran >= most else min(2 * own.back_off, most)
        own.state, own.due = ProcessState.WAITING, now + own.back_off
        self._outbox.emit(ProcessWaits(node, to_seconds(own.back_off), own.budget.left()))

    def _give_up(self, node: PartName, own: _Process, end: ProcessExit, now: Instant) -> None:
        own.state, own.given_up = ProcessState.GIVEN_UP, _ended(node, end)
        given_up = ProcessGivenUp(node, own.settings.starts, to_seconds(own.settings.within))
        self._outbox.emit(given_up)
        self._set_error(node, own, PROCESS_ENDED, "", now)
        self._set_error(node, own, PROCESS_GIVEN_UP, own.given_up, now)

    def _set_error(
        self, node: PartName, own: _Process, error: str, message: str, now: Instant
    ) -> None:
        """Raise an error with a message, or clear it if that is empty."""
        if own.told.get(error, "") == message:
            return
        own.told[error] = message
        found = Found(ErrorState.ACTIVE, message) if message else None
        self._errors.note_found(node, error, found, now)

    def _keep(self, node: PartName, own: _Process, now: Instant) -> None:
        """Keep how a process stands, if that is more than that it may run."""
        value = KeptProcess(node, not own.is_wanted, own.given_up, own.budget.ages(now))
        if value == KeptProcess(node):
            if own.kept is not None:
                own.kept = None
                self._outbox.forget(KeptProcess, value.name)
        elif value != own.kept:
            own.kept = value
            self._outbox.keep(value)


def _ended(node: PartName, end: ProcessExit) -> str:
    return f"the process of {node} ended: {end.words}"


def _described(report: ProcessReport) -> Event:
    """Return the event that records a report."""
    if report.pid is not None:
        return ProcessStarted(report.node, report.pid)
    end = report.exit
    if end is None:
        return ProcessReady(report.node)
    return ProcessEnded(report.node, end.code, end.signal, end.words)
