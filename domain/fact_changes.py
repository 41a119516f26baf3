"""Notes which facts an input changed, and evaluates the conditions that name them."""

from collections.abc import Hashable, Iterable, Mapping, Set
from typing import TypeVar

from domain.concern import Concern, Takers
from domain.conditions.tree import Topic, TopicKind
from domain.conditions.watched import WatchedConditions
from domain.inputs import NodeReport
from domain.outbox import Outbox
from domain.snapshot import ErrorKey
from domain.state_and_mode import PartName
from domain.tasks.driving import Driving
from domain.timebase import Instant

KeyT = TypeVar("KeyT", bound=Hashable)

_ROBOT, _TASK, _VEHICLE = map(Topic, (TopicKind.ROBOT, TopicKind.TASK, TopicKind.VEHICLE))


class FactChanges(Concern):
    """Touches the topics that changed, and nothing else; without conditions it costs nothing."""

    def __init__(self, watched: WatchedConditions, driving: Driving, outbox: Outbox) -> None:
        """Follow what changes.

        Args:
            watched: All conditions; none is added later.
            driving: Whose holds are named by conditions.
            outbox: Tells what the current input changed so far.
        """
        self._watched = watched
        self._driving = driving
        self._outbox = outbox
        topics = watched.topics
        self._is_idle = not topics
        self._signals = _by_name(topics, TopicKind.SIGNAL)
        self._parts = _by_name(topics, TopicKind.PART)
        self._errors = {
            ErrorKey(PartName(topic.part) if topic.part else None, topic.name): topic
            for topic in topics
            if topic.kind is TopicKind.ERROR
        }
        self._holds = [topic for topic in topics if topic.kind is TopicKind.HOLD]
        self._seen: object = None
        """The holds as they were evaluated last."""

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {NodeReport: self._take_report}

    def _take_report(self, report: NodeReport, now: Instant) -> None:
        """Touch a node that reports parameters: they may change nothing else about it."""
        topic = self._parts.get(report.node) if report.parameters else None
        if topic is not None:
            self._watched.touch(topic)

    def settle(self, now: Instant) -> bool:
        """Evaluate the conditions that name what changed; return whether one has another value."""
        if self._is_idle:
            return False
        self._touch_named(self._outbox.signals, self._signals)
        self._touch_named(self._outbox.parts, self._parts)
        self._touch_named(self._outbox.errors, self._errors)
        if (holds := self._driving.holds) is not self._seen:
            # A pose that is too old sets a hold.
            self._touch((*self._holds, _VEHICLE))
            self._seen = holds
        if self._outbox.system_state:
            self._touch((_ROBOT, _TASK))
        if self._outbox.task_changed:
            self._touch((_TASK,))
        if self._outbox.vehicle_changed:
            self._touch((_VEHICLE,))
        return bool(self._watched.renew(now))

    def _touch_named(self, changed: Set[KeyT], named: Mapping[KeyT, Topic]) -> None:
        """Touch what is in both; the smaller one may be far smaller."""
        names = changed if len(changed) < len(named) else named
        self._touch(named[name] for name in names if name in changed and name in named)

    def _touch(self, topics: Iterable[Topic]) -> None:
        for topic in topics:
            self._watched.touch(topic)


def _by_name(topics: Iterable[Topic], kind: TopicKind) -> dict[str, Topic]:
    return {topic.name: topic for topic in topics if topic.kind is kind}
