"""Notes which facts an input changed, and evaluates the conditions that name them."""

from collections.abc import Hashable, Iterable, Iterator, Mapping, Set
from typing import TypeVar

from domain.concern import Concern, Takers
from domain.conditions.tree import Topic, TopicKind
from domain.conditions.watched import WatchedConditions
from domain.inputs import NodeReport
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.snapshot import ErrorKey
from domain.state_and_mode import PartName
from domain.tasks.driving import Driving
from domain.timebase import Instant

KeyT = TypeVar("KeyT", bound=Hashable)

_ROBOT, _TASK, _VEHICLE = map(Topic, (TopicKind.ROBOT, TopicKind.TASK, TopicKind.VEHICLE))


class FactChanges(Concern):
    """Touches the topics that changed, and nothing else; without conditions it costs nothing."""

    def __init__(
        self, watched: WatchedConditions, parts: Parts, driving: Driving, outbox: Outbox
    ) -> None:
        """Follow what changes.

        Args:
            watched: All conditions; none is added later.
            parts: Their states and modes are named by conditions.
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
        names = watched.parts_named_by("converged")
        self._converging = {name: self._parts[name] for name in sorted(names)}
        self._inference = parts.inference
        self._ancestors = parts.model.ancestors
        self._reported: set[PartName] = set()
        """Parts about which more than their target may have changed since the last `settle`."""
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
        self._watched.may_have_changed = True
        topic = self._parts.get(report.node)
        if topic is not None and report.parameters:
            self._watched.touch(topic)
        if self._parts:
            self._reported.update((report.node, *self._ancestors[report.node]))

    def wake_at(self) -> Instant | None:
        """Return when time alone changes a fact: the concerns before know."""
        return None

    def pass_time(self, now: Instant) -> None:
        """Note that a signal may have become stale."""
        self._watched.may_have_changed = True

    def settle(self, now: Instant) -> bool:
        """Evaluate the conditions that name what changed; return whether one has another value."""
        if self._is_idle:
            return False
        self._touch(_named(self._outbox.signals, self._signals))
        self._touch_parts()
        self._touch(_named(self._outbox.errors, self._errors))
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

    def _touch_parts(self) -> None:
        """Touch the parts about which more changed than their targets.

        A request gives ten thousand of them other targets. A condition cannot name these, but it
        can name whether a part has converged.
        """
        self._reported |= self._inference.take_moved()
        if self._reported:
            self._touch(_named(self._reported, self._parts))
            self._reported.clear()
        if self._converging and self._outbox.parts:
            self._touch(_named(self._outbox.parts, self._converging))

    def _touch(self, topics: Iterable[Topic]) -> None:
        for topic in topics:
            self._watched.touch(topic)


def _named(changed: Set[KeyT], named: Mapping[KeyT, Topic]) -> Iterator[Topic]:
    """Yield what is in both; the smaller one may be far smaller."""
    if len(changed) < len(named):
        yield from (named[key] for key in changed if key in named)
    else:
        yield from (topic for key, topic in named.items() if key in changed)


def _by_name(topics: Iterable[Topic], kind: TopicKind) -> dict[str, Topic]:
    return {topic.name: topic for topic in topics if topic.kind is kind}
