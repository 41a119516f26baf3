"""All services and topics that Pilothouse offers to ROS; needs no ROS itself."""

import asyncio
import logging
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from itertools import chain

from domain.timebase import seconds
from service.event_log import EventReader, Gap
from service.ros.interface.audit import audited
from service.ros.interface.checkpoint_topic import checkpoint_topic
from service.ros.interface.endpoints import (
    Fields,
    Listeners,
    OfferedService,
    OfferedTopic,
    SubscribedTopic,
)
from service.ros.interface.overlay import PATH, Overlay
from service.ros.interface.part_topics import PartTopics
from service.ros.interface.reading_topics import reading_topics
from service.ros.interface.robot_topics import RobotTopics
from service.ros.interface.services import LifecycleServices, ModeServices, robot_services
from service.ros.interface.settings import USUAL_SETTINGS, InterfaceSettings
from service.ros.interface.task_services import TaskServices
from service.supervisor import Supervisor
from service.worker import InlineJobs, Jobs

log = logging.getLogger(__name__)

_TURN = seconds(0.001)
"""Time for converting events in one pass of the event loop, since a change of a thousand nodes
produces events faster than a fixed small number per pass can handle."""


class RosInterface:
    """Services and topics of all parts and of the robot, and the subscribed topics."""

    def __init__(
        self,
        supervisor: Supervisor,
        settings: InterfaceSettings = USUAL_SETTINGS,
        jobs: Jobs | None = None,
    ) -> None:
        """Prepare.

        Args:
            supervisor: Of the robot.
            settings: Of the robot file.
            jobs: Do what would keep the event loop; None: it is done here.
        """
        self._supervisor = supervisor
        self.parts = supervisor.model.parts
        """Names of the parts, in the order of the model."""
        self._listeners = Listeners()
        self._part_topics = PartTopics(supervisor, self._listeners)
        self._robot_topics = RobotTopics(supervisor, self._listeners, settings.messages)
        self._overlay = Overlay(supervisor, self._listeners, settings.frame_id)
        services = chain(
            *(LifecycleServices(supervisor, part).offered() for part in self.parts),
            *(ModeServices(supervisor, part).offered() for part in self.parts),
            robot_services(supervisor),
            TaskServices(supervisor, settings.folder, jobs or InlineJobs()).offered(),
        )
        offering = (self._part_topics, self._robot_topics, self._overlay)
        topics = chain.from_iterable(each.offered() for each in offering)
        self.services: Mapping[str, OfferedService] = {
            service.name: audited(supervisor, service) if service.writes else service
            for service in services
        }
        """By full name."""
        self.topics: Mapping[str, OfferedTopic] = {topic.name: topic for topic in topics}
        """By full name."""
        heard = (*reading_topics(supervisor, settings.messages), checkpoint_topic(supervisor))
        self.heard: Mapping[str, SubscribedTopic] = {topic.name: topic for topic in heard}
        """By full name."""

    def listen(self, topic: str, take: Callable[[Fields], None]) -> Callable[[], None]:
        """Pass each message of a topic to `take`; return a function that ends this.

        Args:
            topic: Full name of one of `topics`.
            take: Must return at once and not raise. For a latched topic it gets the last message,
                if there is one, before this function returns.
        """
        last = self._last(topic) if self.topics[topic].latched else None
        if last is not None:
            take(last)
        return self._listeners.add(topic, take)

    def _last(self, topic: str) -> Fields | None:
        return self._overlay.last() if topic == PATH else self._part_topics.last(topic)

    async def run(self) -> None:
        """Publish messages about events and states to the listeners, until cancelled.

        Must not run twice at the same time. It may be run again later: events in between are not
        published, but the latched requests are up to date.
        """
        events, frames = self._supervisor.events, self._supervisor.frames
        reader = EventReader(events)
        self._part_topics.recall(events)
        changed = asyncio.Event()
        with ExitStack() as watching:
            watching.enter_context(events.watch(changed.set))
            watching.enter_context(frames.watch(changed.set))
            while True:
                await self._tell_events(reader)
                self._robot_topics.take(frames)
                self._overlay.take(frames)
                await changed.wait()
                changed.clear()

    async def _tell_events(self, reader: EventReader) -> None:
        clock, missed = self._supervisor.clock, False
        while reader.is_behind or self._part_topics.has_unsent:
            ends_at = clock.now() + _TURN
            while clock.now() < ends_at:
                if self._part_topics.has_unsent:
                    self._part_topics.send_next()
                elif reader.is_behind:
                    missed = self._take_next(reader) or missed
                else:
                    break
            if missed and not reader.is_behind:
                self._part_topics.catch_up()
                missed = False
            await asyncio.sleep(0)

    def _take_next(self, reader: EventReader) -> bool:
        """Publish the next event; return whether events before it were missed."""
        missed = False
        for event in reader.take(1):
            if isinstance(event, Gap):
                log.warning("missed events %d to %s", event.first, event.last)
                missed = True
            else:
                self._part_topics.take(event)
        return missed
