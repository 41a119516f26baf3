"""The checkpoints of all nodes as a concern: it raises and clears their errors."""

from collections.abc import Mapping

from domain.concern import Concern, Takers
from domain.deadlines import Deadlines
from domain.errors import UnknownCheckpointError, UnknownPartError
from domain.events.parts import CheckpointReached
from domain.health.checkpoints import CheckpointSettings, NodeCheckpoints
from domain.health.error_list import Found
from domain.health.health import Health
from domain.health.part_errors import PartErrors
from domain.inputs import CheckpointReport, NodeReport
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.snapshot import ErrorState
from domain.state_and_mode import PartName
from domain.timebase import Instant


class CheckpointErrors(Concern):
    """Supervises the checkpoints of each node while it is active.

    While nothing is known of its state, its errors stay as they are: that it is unreachable has an
    error of its own. Each time it becomes active, supervision begins anew.
    """

    def __init__(
        self,
        settings: Mapping[PartName, CheckpointSettings],
        parts: Parts,
        health: Health,
        errors: PartErrors,
        outbox: Outbox,
    ) -> None:
        self._parts = parts
        self._health = health
        self._errors = errors
        self._outbox = outbox
        self._nodes = {node: NodeCheckpoints(own) for node, own in settings.items()}
        self._states: dict[PartName, LifecycleState] = {}
        """Known state of each of these nodes, as it was supervised last."""
        self._deadlines: Deadlines[PartName] = Deadlines()

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {CheckpointReport: self.take_checkpoint, NodeReport: self.take_report}

    def take_checkpoint(self, report: CheckpointReport, now: Instant) -> None:
        """Note that a node reached a checkpoint.

        Raises:
            UnknownPartError: The model has no such node.
            UnknownCheckpointError: The node has no such checkpoint.
        """
        node = report.node
        if node not in self._parts.model.nodes:
            raise UnknownPartError("node", node, tuple(self._parts.model.nodes))
        checkpoints = self._nodes.get(node)
        known = () if checkpoints is None else checkpoints.names
        if checkpoints is None or report.checkpoint not in known:
            hint = None if known else f"the robot file has no checkpoints of {node}"
            raise UnknownCheckpointError(f"checkpoint of {node}", report.checkpoint, known, hint)
        self._outbox.begin(now, CheckpointReached(node, report.checkpoint), report.actor)
        checkpoints.reach(report.checkpoint, now, is_late=self._health.is_late)
        self._judge(node, now)

    def take_report(self, report: NodeReport, now: Instant) -> None:
        """Supervise a node while it is active."""
        node = report.node
        checkpoints = self._nodes.get(node)
        if checkpoints is None:
            return
        state = self._parts.facts[node].known_state
        if state is self._states.get(node):
            return
        self._states[node] = state
        if state is LifecycleState.ACTIVE:
            checkpoints.begin(now)
        elif state is LifecycleState.UNKNOWN:
            checkpoints.pause()
        else:
            checkpoints.end(now)
        self._judge(node, now)

    def wake_at(self) -> Instant | None:
        """Return when time alone raises or clears an error."""
        return self._deadlines.next()

    def pass_time(self, now: Instant) -> None:
        """Raise and clear the errors that are due."""
        while (node := self._deadlines.pop_due(now)) is not None:
            self._judge(node, now)

    def _judge(self, node: PartName, now: Instant) -> None:
        checkpoints = self._nodes[node]
        for error, problem in checkpoints.judge(now, is_late=self._health.is_late).items():
            found = None if problem is None else Found(ErrorState.ACTIVE, *problem)
            self._errors.note_found(node, error, found, now)
        due = checkpoints.wake_at()
        if due is None:
            self._deadlines.clear(node)
        else:
            self._deadlines.set(node, due)
