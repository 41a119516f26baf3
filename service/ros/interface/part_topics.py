"""The topics of parts: their actual states and modes, and their targets.

Two topics publish the actual state and mode of a part (`transition_event`, `mode_event`), and two
its target (`transition_request_info`, `mode_request_info`), as the mode manager of the micro-ROS
deliverable D4.8 does. A target is published on one topic only: if it has a mode, which means active
in that mode, on that for modes, else on that for transitions. So of the last messages on both
topics, the one with the later timestamp is in force.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from domain.events.changes import ChangeRequested
from domain.events.event import RecordedEvent
from domain.events.parts import PartActualChanged
from domain.lifecycle import LifecycleState, Transition, rule_for
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.timebase import Instant
from service.event_log import EventLog
from service.ros.interface.endpoints import OWN_NODE, Fields, Listeners, OfferedTopic
from service.ros.interface.message_fields import mode_event, nanoseconds, transition_event
from service.supervisor import Supervisor

TRANSITION_EVENT = "transition_event"
TRANSITION_REQUEST = "transition_request_info"
MODE_EVENT = "mode_event"
MODE_REQUEST = "mode_request_info"
_TYPES = {
    TRANSITION_EVENT: "lifecycle_msgs/msg/TransitionEvent",
    TRANSITION_REQUEST: "lifecycle_msgs/msg/TransitionEvent",
    MODE_EVENT: "system_modes_msgs/msg/ModeEvent",
    MODE_REQUEST: "system_modes_msgs/msg/ModeEvent",
}
_UNKNOWN = StateAndMode(LifecycleState.UNKNOWN)
_LATCHED = frozenset({TRANSITION_REQUEST, MODE_REQUEST})


@dataclass(frozen=True, slots=True)
class _Request:
    """A request for a part."""

    at: Instant
    start: StateAndMode
    goal: StateAndMode
    transition: Transition | None = None
    """None: a mode was requested, or the target follows from a request for another part."""


class PartTopics:
    """The topics of all parts, fed with the events of the log."""

    def __init__(self, supervisor: Supervisor, listeners: Listeners) -> None:
        self._supervisor = supervisor
        self._listeners = listeners
        self._requests: dict[str, _Request] = {}
        """The last request on each topic; its message is made when it is needed."""
        self._unsent: deque[tuple[str, _Request]] = deque()
        """Requests that are still to be published: one for a system concerns all its nodes."""
        self._targets: dict[PartName, StateAndMode] = {}
        """The targets as published last."""
        self._actuals: dict[PartName, StateAndMode] = {}
        """Actual states as of the last event taken; the core may be ahead of them."""

    def offered(self) -> Iterator[OfferedTopic]:
        """Yield all topics; a node in a ROS graph publishes its transitions itself."""
        model = self._supervisor.model
        for part in model.parts:
            is_node = part in model.nodes
            for kind, type_name in _TYPES.items():
                yield OfferedTopic(
                    name=_topic(part, kind),
                    type=type_name,
                    node=OWN_NODE if is_node else part,
                    of_a_node=is_node and kind == TRANSITION_EVENT,
                    latched=kind in _LATCHED,
                )

    @property
    def has_unsent(self) -> bool:
        """Tell whether a request is still to be published."""
        return bool(self._unsent)

    def send_next(self) -> None:
        """Publish the next request; there must be one."""
        topic, request = self._unsent.popleft()
        if self._listeners.hears(topic):
            self._listeners.send(topic, self._message(topic, request))

    def take(self, event: RecordedEvent) -> None:
        """Publish what an event means for parts, if anything; requests follow by `send_next`."""
        match event.event:
            case PartActualChanged(part, actual, was):
                self._tell_step(part, was, actual, event.at)
            case ChangeRequested():
                self._tell_request(event.event, event.at)

    def recall(self, events: EventLog) -> None:
        """Restore the latched requests for late subscribers, and the actual states.

        The start states of the requests are not known any more, nor are the times of requests
        before the oldest event.
        """
        self._targets.clear()
        self._actuals.clear()
        for event in events.newest_first():
            # Otherwise a newer request, for this part or one above it, is known already.
            request = event.event
            if isinstance(request, ChangeRequested) and request.part not in self._targets:
                self._tell_request(request, event.at)
        oldest = next(events.oldest_first(), None)
        self._tell_targets(self._supervisor.clock.now() if oldest is None else oldest.at)
        parts = self._supervisor.core.parts()
        self._actuals = {part: view.actual.state_and_mode for part, view in parts.items()}

    def catch_up(self) -> None:
        """Publish the actual states and targets that were not published yet.

        Called after events were missed; of several steps of a part only one is published.
        """
        now = self._supervisor.clock.now()
        for part, view in self._supervisor.core.parts().items():
            was = self._actuals.get(part, _UNKNOWN)
            self._tell_step(part, was, view.actual.state_and_mode, now)
        self._tell_targets(now)

    def last(self, topic: str) -> Fields | None:
        """Return the last message of a latched topic; None: there is none yet."""
        request = self._requests.get(topic)
        return None if request is None else self._message(topic, request)

    def _tell_step(self, part: PartName, was: StateAndMode, now: StateAndMode, at: Instant) -> None:
        self._actuals[part] = now
        timestamp = nanoseconds(self._supervisor.clock, at)
        topic = _topic(part, TRANSITION_EVENT)
        if now.state is not was.state and self._listeners.hears(topic):
            step = _step(was.state, now.state)
            self._listeners.send(topic, transition_event(timestamp, step, was.state, now.state))
        topic = _topic(part, MODE_EVENT)
        if now.mode != was.mode and self._listeners.hears(topic):
            self._listeners.send(topic, mode_event(timestamp, was.mode, now.mode))

    def _tell_request(self, request: ChangeRequested, at: Instant) -> None:
        for topic in self._note_request(request, at):
            self._send_request(topic)

    def _tell_targets(self, at: Instant) -> None:
        """Publish the targets that were not published yet, with that time of request."""
        for part, view in self._supervisor.core.parts().items():
            told = self._targets.get(part)
            if view.target is not None and not (told and view.target.agrees_with(told)):
                self._send_request(self._note(part, view.target, at))

    def _send_request(self, topic: str) -> None:
        self._unsent.append((topic, self._requests[topic]))

    def _note_request(self, request: ChangeRequested, at: Instant) -> list[str]:
        """Store the request for a part and all parts below it, and return the topics concerned."""
        asked = request.part
        goal = _goal(request)
        if goal is None:
            return []
        topics = [self._note(asked, goal, at, request.transition)]
        for part in self._below(asked):
            target = self._supervisor.core.part(part).target
            told = self._targets.get(part)
            if target is not None and not (told and target.agrees_with(told)):
                topics.append(self._note(part, target, at))
        return topics

    def _note(
        self, part: PartName, goal: StateAndMode, at: Instant, transition: Transition | None = None
    ) -> str:
        self._targets[part] = goal
        topic = _topic(part, MODE_REQUEST if goal.mode else TRANSITION_REQUEST)
        start = self._actuals.get(part, _UNKNOWN)
        self._requests[topic] = _Request(at, start, goal, transition)
        return topic

    def _below(self, asked: PartName) -> Iterator[PartName]:
        """Yield the parts below one, each once."""
        systems = self._supervisor.model.systems
        seen = {asked}
        waiting = [asked]
        while waiting:
            system = systems.get(waiting.pop())
            # Including parts that only some modes of the system name.
            for part in system.named_parts if system else ():
                if part not in seen:
                    seen.add(part)
                    waiting.append(part)
                    yield part

    def _message(self, topic: str, request: _Request) -> Fields:
        timestamp = nanoseconds(self._supervisor.clock, request.at)
        start, goal = request.start, request.goal
        if topic.endswith(MODE_REQUEST):
            return mode_event(timestamp, start.mode, goal.mode)
        return transition_event(timestamp, request.transition, start.state, goal.state)


def _topic(part: PartName, kind: str) -> str:
    return f"/{part}/{kind}"


def _goal(request: ChangeRequested) -> StateAndMode | None:
    """Return the requested target; None: the request is for parameters."""
    if request.mode is not None:
        return StateAndMode(LifecycleState.ACTIVE, ModeName(request.mode))
    return None if request.transition is None else StateAndMode(request.transition.goal)


def _step(was: LifecycleState, now: LifecycleState) -> Transition | None:
    """Return the transition from one state to another, or to an intermediate state."""
    for transition in Transition:
        rule = rule_for(was, transition)
        if rule is not None and now in (rule.via, rule.success):
            return transition
    return None
