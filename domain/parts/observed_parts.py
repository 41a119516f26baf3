"""The parts as an onlooker knows them, who requests nothing: from reports and announced targets."""

from dataclasses import dataclass

from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.parts.system_model import SmhModel
from domain.snapshot import PartView
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from domain.timebase import Instant


@dataclass(frozen=True, slots=True)
class AnnouncedTarget:
    """The target of a part, as whoever manages the modes of the robot announces it."""

    part: PartName
    state: LifecycleState
    mode: ModeName | None = None
    """None: no mode was named; active then means `__DEFAULT__`, as in system_modes."""
    stamp: int = 0
    """When it was requested, by the sender's clock, ns since 1970; 0: the sender does not say."""


class ObservedParts:
    """Facts, targets and inferred states of all parts, by the same rules as in the core.

    Targets with a mode and those without are announced on two topics. Each topic brings its last
    message to those who come late, and the order of the two is not known then: the later stamp
    counts.
    """

    def __init__(self, model: SmhModel) -> None:
        """Begin with all nodes unknown and no targets."""
        self.model = model
        self._outbox = Outbox()
        self._parts = Parts(model, self._outbox)
        self._announced: dict[PartName, dict[bool, AnnouncedTarget]] = {}
        """The last target of each part with a mode, and the last one without."""

    @property
    def has_targets(self) -> bool:
        """Tell whether somebody announced the target of a part."""
        return bool(self._announced)

    def take_report(self, report: NodeReport, now: Instant) -> None:
        """Process a report of a node.

        Raises:
            InvalidValueError: A value is not a ROS 2 parameter value.
            UnknownPartError: The node is not in the model.
        """
        self._parts.take_report(report, now)
        self._settle(now)

    def take_target(self, target: AnnouncedTarget, now: Instant) -> None:
        """Process an announced target.

        Raises:
            UnknownPartError: The part is not in the model.
        """
        part = target.part
        modes = self.model.modes_of(part)
        announced = self._announced.setdefault(part, {})
        announced[target.mode is not None] = target
        other = announced.get(target.mode is None)
        if other is not None and 0 < target.stamp < other.stamp:
            target = other
        mode = target.mode
        if mode is None and target.state is LifecycleState.ACTIVE and modes:
            mode = DEFAULT_MODE
        self._parts.ask({part: StateAndMode(target.state, mode)})
        self._settle(now)

    def take_changed(self) -> set[PartName]:
        """Return the parts whose views changed since the last call."""
        return self._parts.take_changed()

    def view(self, part: PartName) -> PartView:
        """Return the view of a part of the model; the same object until it changes."""
        return self._parts.view(part)

    def _settle(self, now: Instant) -> None:
        while self._parts.settle(now) or self._parts.has_more:
            self._parts.go_on(now)
        # Events, which nobody reads here.
        self._outbox.take()
