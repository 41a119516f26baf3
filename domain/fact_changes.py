"""Notes which facts an input changed, and evaluates the conditions that name them."""

from collections.abc import Iterable, Mapping, Set

from domain.concern import Concern
from domain.conditions.tree import Topic, TopicKind
from domain.conditions.watched import WatchedConditions
from domain.health.health import Health
from domain.outbox import Outbox
from domain.tasks.driving import Driving
from domain.timebase import Instant

_ROBOT, _TASK, _VEHICLE = map(Topic, (TopicKind.ROBOT, TopicKind.TASK, TopicKind.VEHICLE))


class FactChanges(Concern):
    """Touches the topics that changed, and nothing else; without conditions it costs nothing."""

    def __init__(
        self, watched: WatchedConditions, health: Health, driving: Driving, outbox: Outbox
    ) -> None:
        """Follow what changes.

        Args:
            watched: All conditions; none is added later.
            health: Whose errors are named by conditions.
            driving: Whose holds are.
            outbox: Tells what the current input changed so far.
        """
        self._watched = watched
        self._health = health
        self._driving = driving
        self._outbox = outbox
        topics = watched.topics
        self._is_idle = not topics
        self._signals = _by_name(topics, TopicKind.SIGNAL)
        self._parts = _by_part(topics)
        self._errors = [t for t in topics if t.kind is TopicKind.ERROR and not t.part]
        self._holds = [topic for topic in topics if topic.kind is TopicKind.HOLD]
        self._seen: tuple[object, object] = (None, None)
        """Errors and holds as they were evaluated last."""

    def settle(self, now: Instant) -> bool:
        """Evaluate the conditions that name what changed; return whether one has another value."""
        if self._is_idle:
            return False
        self._touch_named(self._outbox.signals, self._signals)
        self._touch_named(self._outbox.parts, self._parts)
        errors, holds = self._health.errors, self._driving.holds
        if errors != self._seen[0]:
            self._touch(self._errors)
        if holds is not self._seen[1]:
            # A pose that is too old sets a hold.
            self._touch((*self._holds, _VEHICLE))
        self._seen = (errors, holds)
        if self._outbox.system_state:
            self._touch((_ROBOT, _TASK))
        if self._outbox.task_changed:
            self._touch((_TASK,))
        if self._outbox.vehicle_changed:
            self._touch((_VEHICLE,))
        return bool(self._watched.renew(now))

    def _touch_named(self, changed: Set[str], named: Mapping[str, list[Topic]]) -> None:
        """Touch what is in both; the smaller one may be far smaller."""
        names = changed if len(changed) < len(named) else named
        for name in names:
            if name in changed and name in named:
                self._touch(named[name])

    def _touch(self, topics: Iterable[Topic]) -> None:
        for topic in topics:
            self._watched.touch(topic)


def _by_name(topics: Iterable[Topic], kind: TopicKind) -> dict[str, list[Topic]]:
    return {topic.name: [topic] for topic in topics if topic.kind is kind}


def _by_part(topics: Iterable[Topic]) -> dict[str, list[Topic]]:
    """Return the topics of each part: itself and its errors, which follow from what it is in."""
    found: dict[str, list[Topic]] = {}
    for topic in topics:
        name = topic.name if topic.kind is TopicKind.PART else topic.part
        if name:
            found.setdefault(name, []).append(topic)
    return found
