"""Encodes frames and events as JSON, once for all clients that get the same text."""

import asyncio
from collections import OrderedDict
from collections.abc import Callable, Iterator
from typing import TypeAlias, TypeVar

from api.distribution import installed_version
from api.http.page.assembled_page import assembled_page
from api.http.problems import problem_of
from api.http.schemas.base import timestamp
from api.http.schemas.stream import GapJson, HelloJson, ReplayJson
from api.streaming.client_input import STATE_TOPICS, TOPICS
from api.streaming.robot_encoder import MemberCache, RobotEncoder, View
from domain.errors import PilothouseError
from domain.timebase import to_seconds
from service.event_log import DEFAULT_CAPACITY, Gap
from service.frame_feed import PARTS_AT_ONCE, Frame
from service.frame_publisher import PERIOD
from service.history.event_history import ToldEvent
from service.storage.journal import StoredEvent
from service.supervisor import Supervisor

_EVENTS_KEPT = DEFAULT_CAPACITY
"""All that a client can ask for, some 5 MB: two hundred clients that come back at different places
would otherwise have the same events encoded again and again."""
_EARLIER_KEPT = 2_000
"""Of the events that are read from the journal, for clients that come back together."""
_MEMBERS_AT_ONCE = 200
"""About 5 ms. The frames of a robot that changes fast have some more, and each further turn delays
them by what others do in it."""
_PASSES = 3
"""Over the parts that changed, each for those that changed during the one before."""
_PATH = "/ws"

Told = TypeVar("Told", bound=ToldEvent)
_Shape: TypeAlias = tuple[bool, frozenset[str]]
"""Distinguishes the texts of one frame: whether it is complete, and its topics."""


class StreamEncoder:
    """Texts of frames and events, cached while a client may still need them."""

    def __init__(self, supervisor: Supervisor) -> None:
        self._supervisor = supervisor
        self._clock = supervisor.clock
        self._robot = RobotEncoder(supervisor)
        self._texts: dict[_Shape, tuple[Frame, _StateText]] = {}
        """The newest text of each shape, shared by the clients of the same topics."""
        self._events: OrderedDict[int, str] = OrderedDict()
        """Ordered, since the first entry of a plain one is found behind all that were removed."""
        self._earlier: OrderedDict[int, str] = OrderedDict()
        self.replay: Callable[[], ReplayJson | None] = lambda: None
        """Tells how a recording is shown; None: it is a robot."""
        self._prepared: dict[str, int] = {}
        """By topic, number of the frame up to which its members are encoded."""

    def hello(self, topics: frozenset[str]) -> str:
        """Return the `hello` frame."""
        return HelloJson(
            epoch=self._supervisor.epoch,
            boot=self._supervisor.boot,
            started_at=timestamp(self._clock, self._supervisor.started_at),
            model=self._supervisor.model_name,
            newest=self._supervisor.events.newest,
            topics=[topic for topic in TOPICS if topic in topics],
            period_s=to_seconds(PERIOD),
            version=installed_version(),
            page_version=assembled_page().version,
            replay=self.replay(),
        ).model_dump_json()

    async def prepare(self, topics: frozenset[str]) -> None:
        """Encode changed parts and errors a few at a time, and let other tasks run in between.

        A client may be sent a complete frame next, and parts go on changing meanwhile: what is left
        for one turn is little, unless parts change faster than they can be encoded.
        """
        feed, robot = self._supervisor.frames, self._robot
        if "parts" in topics:
            await self._prepare("parts", robot.parts, feed.parts_since)
        if "errors" in topics:
            await self._prepare("errors", robot.errors, feed.errors_since)

    async def _prepare(
        self,
        topic: str,
        cache: MemberCache[View],
        since: Callable[[int], Iterator[tuple[str, View]]],
    ) -> None:
        """Encode the changed members of one topic.

        Args:
            topic: Its name.
            cache: Holds the texts of its members.
            since: Yields those that changed after a frame.
        """
        feed = self._supervisor.frames
        for _ in range(_PASSES):
            if feed.newest is None:
                return
            new = list(cache.new_ones(since(self._prepared.get(topic, 0))))
            self._prepared[topic] = feed.newest.seq
            for start in range(0, len(new), _MEMBERS_AT_ONCE):
                cache.learn(new[start : start + _MEMBERS_AT_ONCE])
                if len(new) > _MEMBERS_AT_ONCE:
                    await asyncio.sleep(0)
            if len(new) <= PARTS_AT_ONCE:
                return

    def frame(self, frame: Frame, skipped: int, topics: frozenset[str]) -> bytes:
        """Return a `state` frame as UTF-8; clients with the same topics that skip none share it."""
        known = self._known_text(frame, topics)
        if known is None:
            known = self._encode(frame, topics)
            self._texts[_shape(frame, topics)] = (frame, known)
        return known.after(skipped)

    def event(self, event: ToldEvent) -> str:
        """Return an `event` frame."""
        if isinstance(event, StoredEvent):
            return _remembered(self._earlier, event, self._robot.stored_event, _EARLIER_KEPT)
        return _remembered(self._events, event, self._robot.event, _EVENTS_KEPT)

    def gap(self, gap: Gap) -> str:
        """Return a `gap` frame."""
        return GapJson(first=gap.first, last=gap.last, epoch=gap.epoch).model_dump_json()

    def problem(self, error: PilothouseError) -> str:
        """Return a `problem` frame: a problem document whose `type` is `problem`."""
        document = problem_of(error, self._clock, _PATH)
        return document.model_copy(update={"type": "problem"}).as_json()

    def _known_text(self, frame: Frame, topics: frozenset[str]) -> "_StateText | None":
        known = self._texts.get(_shape(frame, topics))
        return known[1] if known is not None and known[0] is frame else None

    def _encode(self, frame: Frame, topics: frozenset[str]) -> "_StateText":
        at = timestamp(self._clock, frame.at)
        state = self._robot.system_state(frame.system_state, frame.seq, frame.at, frame.simulated)
        members = [_member("system_state", state), *self._changed_members(frame, topics)]
        head = f'{{"type":"state","seq":{frame.seq},"at":"{at}","skipped":'
        return _StateText(head.encode(), b",".join((b"", *members)) + b"}")

    def _changed_members(self, frame: Frame, topics: frozenset[str]) -> Iterator[bytes]:
        robot = self._robot
        if "parts" in topics and (frame.full or frame.parts):
            yield _object("parts", robot.parts.members(frame.parts))
        if "signals" in topics and (frame.full or frame.signals):
            yield _object("signals", robot.signals.members(frame.signals))
        if "errors" in topics and (frame.full or frame.errors):
            yield _object("errors", robot.errors.members(frame.errors))
        if "reactions" in topics and (frame.full or frame.reactions):
            yield _object("reactions", robot.reactions.members(frame.reactions))
        if "devices" in topics and (frame.full or frame.devices):
            yield _object("devices", robot.devices.members(frame.devices))
        if "devices" in topics and frame.lead is not None and frame.lead_changed:
            yield _member("this_device", robot.this_device(frame.lead))
        if "task" in topics and frame.task_changed:
            yield _member("task", robot.task(frame.task))
        if "vehicle" in topics and frame.vehicle_changed:
            yield _member("vehicle", robot.vehicle(frame.vehicle))
        if "holds" in topics and frame.holds_changed:
            yield _member("holds", robot.holds(frame.holds))
        if "emergency_stop" in topics and frame.emergency_stop_changed:
            yield _member("emergency_stop", robot.emergency_stop(frame.emergency_stop))


def _remembered(
    texts: OrderedDict[int, str], event: Told, encode: Callable[[Told], str], most: int
) -> str:
    """Return the text of an event; the newest ones are kept by id."""
    text = texts.get(event.id)
    if text is None:
        text = texts[event.id] = encode(event)
        if len(texts) > most:
            texts.popitem(last=False)
    return text


class _StateText:
    """A `state` frame; only the number of skipped frames may differ between clients."""

    def __init__(self, head: bytes, tail: bytes) -> None:
        self._head = head
        self._tail = tail
        self._in_step = b""

    def after(self, skipped: int) -> bytes:
        """Return the frame for a client that skipped that many frames before it."""
        if skipped:
            return b"%b%d%b" % (self._head, skipped, self._tail)
        if not self._in_step:
            self._in_step = b"%b0%b" % (self._head, self._tail)
        return self._in_step


def _member(name: str, value: str) -> bytes:
    return f'"{name}":{value}'.encode()


def _object(name: str, members: bytes) -> bytes:
    return b'"%b":{%b}' % (name.encode(), members)


def _shape(frame: Frame, topics: frozenset[str]) -> _Shape:
    return frame.full, topics & STATE_TOPICS
