"""A computer of the robot: its nodes, its clock and its disk outlive each process on it."""

from collections import deque
from collections.abc import Mapping
from random import Random

from domain.computers import SUPERVISOR, ComputerName
from domain.inputs import Restored
from domain.kept import Keeping, Kept
from domain.lifecycle import LifecycleState
from domain.link.messages import Message
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault
from domain.simulation.nodes import SimulatedNodes
from domain.state_and_mode import PartName
from domain.timebase import Duration, Instant
from tests.support.network_world.happenings import Store
from tests.support.network_world.processes import Process


class Disk:
    """What is kept over a restart, as it is and as it was at some earlier moments."""

    def __init__(self) -> None:
        self._values: dict[tuple[type[Kept], str], Kept] = {}
        self._next_event = 1
        self._changes = 0
        self._boot = 0
        self._backups: list[Mapping[str, object]] = []

    def keep(self, outputs: Outputs) -> None:
        """Keep and forget what outputs say."""
        for item in outputs.kept:
            self._keep(item)
        if outputs.events:
            self._next_event = outputs.events[-1].id + 1
        kinds = ("change.requested", "node.restoring")
        self._changes += sum(event.kind in kinds for event in outputs.events)

    def _keep(self, item: Keeping) -> None:
        if item.value is None:
            self._values.pop((item.kind, item.name), None)
        else:
            self._values[item.kind, item.name] = item.value

    def back_up(self) -> None:
        """Copy what is there now."""
        state = {name: value for name, value in vars(self).items() if name != "_backups"}
        self._backups.append({**state, "_values": dict(self._values)})

    def open(self, store: Store, run: str, rng: Random) -> Restored:
        """Return what a process that is started finds.

        Args:
            store: Whether it is as it was left.
            run: Name of the process.
            rng: Chooses a backup, if one is put back.
        """
        if store is Store.LOST:
            backups, self._backups = self._backups, []
            self.__init__()  # type: ignore[misc]
            self._backups = backups
        elif store is Store.OLD and self._backups:
            backup = rng.choice(self._backups)
            vars(self).update({**backup, "_values": dict(backup["_values"])})  # type: ignore[call-overload]
        self._boot += 1
        values = tuple(self._values.values())
        return Restored(values, self._boot, self._next_event, self._changes + 1, run=run)


class Computer:
    """One computer. Another one may have the same name: a mistake that must be harmless."""

    def __init__(
        self,
        name: ComputerName,
        endpoint: ComputerName,
        model: SmhModel,
        nodes: tuple[PartName, ...],
        clock_ahead: Duration,
    ) -> None:
        """Begin without a process.

        Args:
            name: In the robot file.
            endpoint: Where the network finds it; like no other.
            model: Of its nodes; they may be among others.
            nodes: Its own.
            clock_ahead: How far its monotonic clock is ahead of that of the world.
        """
        self.name = name
        self.endpoint = endpoint
        self.model = model
        self.node_names = nodes
        self.nodes = SimulatedNodes(model, {}, 0)
        self.nodes.advance(0)
        self.mute: set[PartName] = set()
        self.clock_ahead = clock_ahead
        self.disk = Disk()
        self.process: Process | None = None
        self.asleep_until: Instant = 0
        self.was_asleep = False
        """Whether its process has yet to notice that it slept."""
        self.has_news = True
        """Whether something happened since it was asked when something is due."""
        self._wake_at: Instant | None = None
        self.unread: deque[tuple[ComputerName, Message]] = deque()
        """What came while the process was asleep."""

    @property
    def is_supervisor(self) -> bool:
        """Tell whether it is to supervise."""
        return self.name == SUPERVISOR

    def set_fault(self, node: PartName, fault: Fault | None, now: Instant) -> None:
        """Let something be wrong with a node of its own, or no longer."""
        self.nodes.set_fault(node, fault, now)
        if fault is not None and fault.is_mute:
            self.mute.add(node)
        else:
            self.mute.discard(node)

    def mend(self, node: PartName, now: Instant) -> None:
        """Let nothing be wrong with a node; one that ended is started again."""
        if self.nodes.state_of(node) is LifecycleState.FINALIZED:
            self.set_fault(node, Fault.DIE, now)
        self.set_fault(node, None, now)

    def fall_asleep(self, until: Instant) -> None:
        """Let its process do nothing until then."""
        if self.process is not None:
            self.asleep_until = max(self.asleep_until, until)
            self.was_asleep = True

    def wake_at(self) -> Instant | None:
        """Return when something is due here; found anew only if something happened here."""
        if self.has_news:
            self.has_news = False
            self._wake_at = self._next_wake()
        return self._wake_at

    def _next_wake(self) -> Instant | None:
        if self.process is None:
            return self.nodes.wake_at()
        due = self.process.wake_at()
        return due if due is None else max(due, self.asleep_until)
