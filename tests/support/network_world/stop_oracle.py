"""Emergency stops: all that are connected know of each, and only a release of it ends one."""

from dataclasses import dataclass, field

from domain.commands import AskTransition
from domain.computers import SUPERVISOR, ComputerName, Incarnation, StopId
from domain.inputs import EmergencyStopRequest, Input
from domain.lifecycle import Transition
from domain.link.messages import Beat, Message
from domain.link.outputs import Sending
from domain.timebase import Instant, seconds
from tests.support.network_world.processes import Process, Step

FRESH = seconds(1.0)
"""What was sent within it is no echo of before a loss."""


@dataclass
class _Seen:
    """What was seen of one process."""

    own: frozenset[StopId] = frozenset()
    all: frozenset[StopId] = frozenset()
    certain: set[StopId] = field(default_factory=set)
    """Those of which it was told just now, as an echo showed, by a process that has them."""
    newest: dict[Incarnation, int] = field(default_factory=dict)
    """`seq` of the newest beat that it read, by who sent it."""
    told: dict[ComputerName, tuple[Instant, frozenset[StopId]]] = field(default_factory=dict)
    """When it sent a beat to each computer last, with which stops."""
    sent_at: dict[tuple[ComputerName, int], Instant] = field(default_factory=dict)
    """When it sent each beat."""
    changed_at: Instant | None = None
    """When its own stops changed, until it is known that it told so."""


class StopOracle:
    """Invariants 4 and 6."""

    def __init__(self) -> None:
        self._seen: dict[Incarnation, _Seen] = {}
        self.released: set[StopId] = set()
        """Those that a person saw when releasing."""
        self.forgotten: set[StopId] = set()
        """Those of a process that was started again without the store that had them, or that is
        gone for good."""
        self.counts = {"stops": 0, "told": 0}
        self._owners: dict[StopId, Process] = {}
        """Who engaged it first."""
        self._all_runs: list[Process] = []
        self._left: dict[str, frozenset[StopId]] = {}

    def began(self, process: Process) -> None:
        self._seen[process.incarnation] = _Seen()
        self._all_runs.append(process)

    def ended(self, process: Process, endpoint: str) -> None:
        """Note the stops of a process that ended."""
        self._left[endpoint] = self._seen[process.incarnation].own

    def restored(self, process: Process, endpoint: str) -> None:
        """Note which stops a new process knows no longer."""
        self.forgotten |= self._left.pop(endpoint, frozenset()) - self._own(process)

    def gone(self, endpoint: str) -> None:
        """Note that nobody will start again what ended there."""
        self.forgotten |= self._left.pop(endpoint, frozenset())

    def asked(self, process: Process, request: Input) -> None:
        """Note what a person asks, before it happens."""
        if isinstance(request, EmergencyStopRequest) and not request.engaged:
            self.released |= self._all(process)

    def sent(self, process: Process, sending: Sending) -> None:
        if isinstance(sending.message, Beat):
            stops = frozenset(stop.id for stop in sending.message.stops)
            seen = self._seen[process.incarnation]
            seen.told[sending.to] = (process.now, stops)
            seen.sent_at[sending.to, sending.message.seq] = process.now

    def read(self, process: Process, message: Message) -> None:
        """See what a process knows after it read a message."""
        if not isinstance(message, Beat):
            return
        seen = self._seen[process.incarnation]
        if message.seq <= seen.newest.get(message.incarnation, -1):
            return
        seen.newest[message.incarnation] = message.seq
        told = {stop.id for stop in message.stops}
        self.counts["told"] += bool(told)
        # Of the end of a stop it may have heard on another way, before.
        missing = {stop for stop in told - self._all(process) if self._is_engaged(stop)}
        if self._is_fresh(process, message):
            seen.certain |= told
        elif missing:
            missing = {stop for stop in missing if not self._is_replaced(stop)}
        assert not missing, f"{process.name} was told of {missing}, and is not stopped by it"

    def took(self, process: Process, step: Step) -> None:
        seen = self._seen[process.incarnation]
        own, every = self._own(process), self._all(process)
        was_stopped, before = bool(seen.all), seen.own | seen.all
        if own != seen.own:
            seen.changed_at = process.now
        seen.own, seen.all = own, every
        self.counts["stops"] += len(own - before)
        for stop in own:
            self._owners.setdefault(stop, process)
        ended = before - every - self.released
        ended = frozenset(stop for stop in ended if not self._may_end(process, stop))
        assert not ended, f"{ended} ended at {process.name} by {step.given}, and nobody released it"
        is_press = isinstance(step.given, EmergencyStopRequest)
        if was_stopped and every and not is_press:
            for command in step.outputs.commands:
                is_activation = (
                    isinstance(command, AskTransition) and command.transition is Transition.ACTIVATE
                )
                assert not is_activation, f"{command} by {process.name}, which is stopped"

    def _may_end(self, process: Process, stop: StopId) -> bool:
        """Tell whether a stop may end at a process although nobody released it.

        The supervisor keeps those of devices, of which it was told when they were engaged.
        """
        is_kept = process.name == SUPERVISOR and self._owners[stop].name != SUPERVISOR
        if is_kept and stop in self._seen[process.incarnation].certain:
            return False
        return stop in self.forgotten or self._is_replaced(stop)

    def _is_fresh(self, process: Process, beat: Beat) -> bool:
        """Tell whether a beat was sent just now, as its echo shows.

        Otherwise it may be one of a process that was replaced, and its stops those of before.
        """
        sent_at = self._seen[process.incarnation].sent_at.get((beat.sender, beat.heard_seq))
        if sent_at is None or beat.heard != process.incarnation:
            return False
        return process.now - sent_at < FRESH

    def _is_engaged(self, stop: StopId) -> bool:
        owner = self._owners[stop]
        return stop in self._seen[owner.incarnation].own

    def _is_replaced(self, stop: StopId) -> bool:
        """Tell whether a younger process of the same name may have taken the place of its owner.

        From elsewhere it looks as if the owner was started again without the stop.
        """
        owner = self._owners[stop]
        return any(p.name == owner.name and p.started_at > owner.started_at for p in self._all_runs)

    def look(self) -> None:
        """Judge, at the end of an instant, whether all that changed was told at once."""
        for seen in self._seen.values():
            if seen.changed_at is not None:
                for name, (at, stops) in seen.told.items():
                    assert at >= seen.changed_at, f"{name} was not told of {seen.own} at once"
                    assert stops == seen.own, f"{name} was told of {stops}, not of {seen.own}"
                seen.changed_at = None

    @staticmethod
    def _own(process: Process) -> frozenset[StopId]:
        stops = process.core.emergency_stop().stops
        return frozenset(stop.id for stop in stops if stop.computer is None)

    @staticmethod
    def _all(process: Process) -> frozenset[StopId]:
        return frozenset(stop.id for stop in process.core.emergency_stop().stops)
