"""Restores nodes that reappear to their targets.

Only nodes that the settings name: a node that changes state because its process was restarted would
be a surprise, unless it was configured. Nothing else begins a change that nobody requested. After a
restart of the service, nodes that wait for an operator are left as they are.
"""

from collections.abc import Callable, Iterable

from domain.actor import NOBODY
from domain.changes.changes import Changes
from domain.changes.plan import ChangeGoal
from domain.changes.pursuit import request_towards
from domain.changes.record import Step
from domain.changes.settings import ChangeSettings
from domain.errors import BackendUnavailableError, RefusedError
from domain.events.changes import NodeNotRestored, NodeRestoring
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest, NodeReport
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant, seconds, to_seconds

MAX_RESTORES = 3
"""Largest number per node within `WINDOW`, for nodes that crash whenever they are activated."""
WINDOW = seconds(60)

_SEEN_ON_ITS_WAY = frozenset(
    {LifecycleState.UNCONFIGURED, LifecycleState.CLEANING_UP, LifecycleState.ERROR_PROCESSING}
)
"""States from which a process that keeps running becomes unconfigured."""


class Restoring:
    """Notes which nodes reappeared, and restores each once no change is driving it."""

    def __init__(
        self,
        parts: Parts,
        changes: Changes,
        settings: ChangeSettings,
        outbox: Outbox,
        admit: Callable[[ChangeRequest], ChangeGoal],
    ) -> None:
        """Begin without nodes to restore.

        Args:
            parts: Facts, inferred states and targets of all parts.
            changes: Begins the changes that restore nodes.
            settings: Names the nodes to restore.
            outbox: Receives events.
            admit: Returns the goal of a request, or raises the error that rejects it.
        """
        self._parts = parts
        self._inference = parts.inference
        self._changes = changes
        self._restored = settings.restored_nodes
        self._outbox = outbox
        self._admit = admit
        self._returned: dict[PartName, int] = {}
        """By node, the event of the report with which it reappeared."""
        self._begun: dict[PartName, list[Instant]] = {}
        self._given_up: set[PartName] = set()

    def take_report(self, report: NodeReport, step: Step | None) -> None:
        """Note that a node reappeared, unless a change drives it to its target already.

        Args:
            report: The newest report of the node; parts and changes have processed it.
            step: The step that was in flight before the report.
        """
        if self._is_return(report):
            self._note_return(report.node, step)

    def _is_return(self, report: NodeReport) -> bool:
        """Tell whether a node reappeared with the newest report.

        Its state was unknown before; or a complete report says that it is unconfigured, without a
        transition there: its process was restarted before it was found missing.
        """
        if report.node not in self._restored or self._parts.waits_for_operator(report.node):
            return False
        known = self._parts.state_before
        if known is LifecycleState.UNKNOWN:
            return report.reachable is not False
        is_fresh = report.reachable is True and report.state is LifecycleState.UNCONFIGURED
        return is_fresh and known not in _SEEN_ON_ITS_WAY

    def _note_return(self, node: PartName, step: Step | None) -> None:
        if self._inference.facts[node].known_state is LifecycleState.UNKNOWN:
            return
        begun = self._changes.step_in_flight(node)
        # A change that sets parameters brings no node to its target.
        if begun in (None, step) or node not in self._changes.get(begun.change).targets:
            self._returned[node] = self._outbox.record_input()

    def forget(self, parts: Iterable[PartName]) -> None:
        """Drop pending restores of parts that got a new request, and reset their limits."""
        if not (self._returned or self._begun or self._given_up):
            return
        for part in parts:
            self._returned.pop(part, None)
            self._begun.pop(part, None)
            self._given_up.discard(part)

    def cancel(self, change: ChangeId) -> None:
        """Drop pending restores of nodes that wait for the end of a canceled change."""
        for node in [n for n in self._returned if self._parts.change_of(n) == change]:
            del self._returned[node]

    def begin_next(self, now: Instant) -> bool:
        """Begin to restore the next node that can be; return whether a change began."""
        for node, cause in list(self._returned.items()):
            is_gone = not self._inference.facts[node].reachable
            if not is_gone and self._parts.change_of(node) is not None:
                continue
            del self._returned[node]
            target = self._inference.target(node)
            if is_gone or target is None or not self._is_missed(node, target):
                continue
            if self._begin(node, target, cause, now):
                return True
        return False

    def _is_missed(self, node: PartName, target: StateAndMode) -> bool:
        """Tell whether a node is off its target; one that was shut down is left as it is."""
        return target.state is not LifecycleState.FINALIZED and not self._inference.converged(node)

    def _begin(self, node: PartName, target: StateAndMode, cause: int, now: Instant) -> bool:
        if node in self._given_up:
            return False
        begun = [at for at in self._begun.get(node, ()) if now - at < WINDOW]
        if len(begun) == MAX_RESTORES:
            self._given_up.add(node)
            often = f"it was restored {MAX_RESTORES} times within {to_seconds(WINDOW):g} s"
            reason = f"{often}; it is not restored again until a change of it is requested"
            self._tell_not_restored(NodeNotRestored(node, target, reason), cause, now)
            return False
        request = request_towards(
            self._inference.model, self._inference.facts, node, target, NOBODY
        )
        try:
            goal = self._admit(request)
        except (BackendUnavailableError, RefusedError) as refusal:
            self._tell_not_restored(NodeNotRestored(node, target, refusal.message), cause, now)
            return False
        self._begun[node] = [*begun, now]
        self._outbox.begin(now, NodeRestoring(node, target), cause=cause)
        self._changes.begin(node, request, goal, now, is_asked=False)
        return True

    def _tell_not_restored(self, told: NodeNotRestored, cause: int, now: Instant) -> None:
        # An input of its own: the actor of the current input did not request it.
        self._outbox.begin(now, told, cause=cause)
        self._outbox.record_input()
