"""Requests that wait until what their modes require is true."""

from collections.abc import Callable

from domain.changes.admission import ChangeAdmission
from domain.changes.changes import Changes
from domain.changes.guards import Guards
from domain.changes.outcome import joined
from domain.changes.plan import ChangeGoal
from domain.changes.record import Change
from domain.conditions.explanation import CONDITION, UNKNOWN_VALUE
from domain.deadlines import Deadlines
from domain.errors import BackendUnavailableError, RefusedError
from domain.findings import Blocker
from domain.health.health import Health
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest, ModeRequest, ParametersRequest, TransitionRequest
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.snapshot import ChangeStatus
from domain.state_and_mode import PartName
from domain.timebase import Instant, to_seconds

OF_REQUIREMENTS = frozenset({CONDITION, UNKNOWN_VALUE})
"""Codes of the blockers that a request can wait for."""


def may_wait(request: ChangeRequest, blockers: tuple[Blocker, ...]) -> bool:
    """Tell whether a request that is blocked waits for what its modes require, and nothing else."""
    if isinstance(request, ParametersRequest) or request.wait_for is None:
        return False
    return all(each.code in OF_REQUIREMENTS for each in blockers if each.refuses)


class Waiting:
    """The changes that wait; each begins in the step in which all that it requires is true."""

    def __init__(
        self,
        parts: Parts,
        changes: Changes,
        admission: ChangeAdmission,
        guards: Guards,
        health: Health,
        outbox: Outbox,
        admit: Callable[[ChangeRequest], ChangeGoal],
    ) -> None:
        """Begin without any.

        Args:
            parts: Says which nodes a change is about.
            changes: Holds the records, and begins them.
            admission: Judges requests.
            guards: Tell when one of them begins or ceases to hold.
            health: Tells why ESTOP is active.
            outbox: Receives events.
            admit: Returns the goal of a request, or raises the error that rejects it.
        """
        self._parts = parts
        self._changes = changes
        self._admission = admission
        self._guards = guards
        self._health = health
        self._outbox = outbox
        self._admit = admit
        self._waiting: dict[ChangeId, Change] = {}
        self._deadlines: Deadlines[ChangeId] = Deadlines()
        self._seen: tuple[object, ...] = ()
        """What the changes were judged by last."""

    def add(
        self,
        request: ModeRequest | TransitionRequest,
        blockers: tuple[Blocker, ...],
        now: Instant,
    ) -> ChangeId:
        """Let a request wait; it supersedes an earlier one of the same part that waits.

        Args:
            request: It has a time to wait.
            blockers: Those that it waits for.
            now: The current time.
        """
        assert request.wait_for is not None
        why = joined([blocker.message for blocker in blockers if blocker.refuses])
        newer = self._changes.let_wait(request.part, request, now, why)
        self._supersede(lambda part: part == request.part, newer, now)
        self._waiting[newer.id] = newer
        self._deadlines.set(newer.id, now + request.wait_for)
        return newer.id

    def give_way(self, change: ChangeId, part: PartName, now: Instant) -> None:
        """End what waits for a part, or for one below it, of which something newer was begun."""
        if self._waiting:
            ancestors = self._parts.model.ancestors
            newer = self._changes.get(change)
            self._supersede(lambda one: one == part or part in ancestors[one], newer, now)

    def drop(self, change: str) -> None:
        """Forget a change that was canceled."""
        self._waiting.pop(ChangeId(change), None)
        self._deadlines.clear(ChangeId(change))

    def note_report(self, node: PartName) -> None:
        """Judge the changes anew that are about a node."""
        for change in self._waiting.values():
            if node == change.part or change.part in self._parts.model.ancestors[node]:
                self._seen = ()

    def note_backend(self) -> None:
        """Judge all changes anew: none begins while the backend is down."""
        self._seen = ()

    def wake_at(self) -> Instant | None:
        """Return when the time of the next one ends; None: none waits."""
        return self._deadlines.next()

    def pass_time(self, now: Instant) -> None:
        """End those whose time is up."""
        while (identity := self._deadlines.pop_due(now)) is not None:
            change = self._waiting.pop(identity)
            request = change.request
            assert not isinstance(request, ParametersRequest)
            waited = to_seconds(request.wait_for or 0)
            why = joined([blocker.message for blocker in self._blockers(request)])
            self._end(change, ChangeStatus.FAILED, f"waited for {waited:g} s: {why}", now)

    def settle(self, now: Instant) -> bool:
        """Begin or end those of which the blockers changed; return whether there are any."""
        seen = (self._guards.revision, self._health.stop_reasons)
        if not self._waiting or seen == self._seen:
            return False
        self._seen = seen
        has_moved = False
        for change in list(self._waiting.values()):
            if change.id in self._waiting:
                has_moved |= self._move(change, now)
        return has_moved

    # --- inside ----------------------------------------------------------------------------------

    def _move(self, change: Change, now: Instant) -> bool:
        """Begin a change that nothing blocks, or end one that waiting does not help."""
        request = change.request
        refusing = [blocker for blocker in self._blockers(request) if blocker.refuses]
        if refusing and may_wait(request, tuple(refusing)):
            return False
        if refusing:
            why = joined([blocker.message for blocker in refusing])
            self._end(change, ChangeStatus.FAILED, why, now)
            return True
        try:
            goal = self._admit(request)
        except BackendUnavailableError:
            return False
        except RefusedError as refusal:
            self._end(change, ChangeStatus.FAILED, refusal.message, now)
            return True
        self.drop(change.id)
        self._outbox.resume(now, change.cause, request.actor)
        self._parts.note_request(change.part)
        self._changes.begin(change.part, request, goal, now, waited=change)
        self.give_way(change.id, change.part, now)
        return True

    def _blockers(self, request: ChangeRequest) -> tuple[Blocker, ...]:
        return self._admission.blockers(request, self._health.stop_reasons)

    def _supersede(self, concerns: Callable[[PartName], bool], newer: Change, now: Instant) -> None:
        why = f"superseded by change {newer.id} of {newer.part}"
        for change in [one for one in self._waiting.values() if concerns(one.part)]:
            if change is not newer:
                self._end(change, ChangeStatus.SUPERSEDED, why, now)

    def _end(self, change: Change, status: ChangeStatus, why: str, now: Instant) -> None:
        self.drop(change.id)
        self._changes.end_waiting(change, status, why, now)
