"""What rosbridge is over, without a robot: a few topics and services that a test speaks through."""

import asyncio
import json
from collections.abc import Callable, Mapping
from typing import Any

from starlette.types import ASGIApp

from api.rosbridge.bridge import Bridge
from api.streaming.websocket_frames import Connection
from domain.actor import Actor
from domain.errors import InvalidValueError
from service.frame_feed import FrameFeed
from service.refused_readings import RefusedReadings
from service.ros.interface.endpoints import Fields, OfferedService, OfferedTopic, SubscribedTopic
from tests.support.manual_clock import ManualClock
from tests.support.websocket import WebSocketClient

SYSTEM_STATE = OfferedTopic(
    "/system_state", "pilothouse_msgs/msg/SystemState", "pilothouse", False, latched=False
)
MODE_EVENT = OfferedTopic(
    "/actuation/mode_event", "system_modes_msgs/msg/ModeEvent", "actuation", False, latched=False
)
MODE_REQUEST = OfferedTopic(
    "/actuation/mode_request_info",
    "system_modes_msgs/msg/ModeEvent",
    "actuation",
    False,
    latched=True,
)


class SmallInterface:
    """Three topics, one that is heard, and two services; what comes in is kept."""

    def __init__(self) -> None:
        self.topics: Mapping[str, OfferedTopic] = {
            topic.name: topic for topic in (SYSTEM_STATE, MODE_EVENT, MODE_REQUEST)
        }
        estop = SubscribedTopic("/estop", "pilothouse_msgs/msg/EmergencyStop", self._take)
        self.heard: Mapping[str, SubscribedTopic] = {estop.name: estop}
        self.services: Mapping[str, OfferedService] = {
            service.name: service
            for service in (
                OfferedService(
                    "/actuation/change_mode",
                    "system_modes_msgs/srv/ChangeMode",
                    "actuation",
                    False,
                    self._change_mode,
                ),
                OfferedService(
                    "/actuation/get_mode",
                    "system_modes_msgs/srv/GetMode",
                    "actuation",
                    False,
                    self._get_mode,
                ),
            )
        }
        self.readings: list[tuple[Fields, Actor]] = []
        self.asked: list[tuple[Fields, Actor]] = []
        self.answer = asyncio.Event()
        """Set: changes of mode are answered."""
        self.is_broken = False
        """Whether asking for the mode fails in a way that nobody thought of."""
        self.running = 0
        self.last: Fields | None = None
        """Of the latched topic."""
        self._takes: list[tuple[str, Callable[[Fields], None]]] = []

    def listens(self, topic: OfferedTopic) -> int:
        """Return how many listen to a topic."""
        return sum(name == topic.name for name, _ in self._takes)

    def listen(self, topic: str, take: Callable[[Fields], None]) -> Callable[[], None]:
        """Hand messages of a topic to `take`."""
        if topic == MODE_REQUEST.name and self.last is not None:
            take(self.last)
        self._takes.append((topic, take))
        return lambda: self._takes.remove((topic, take))

    def tell(self, topic: OfferedTopic, message: Fields) -> None:
        """Publish a message."""
        for name, take in tuple(self._takes):
            if name == topic.name:
                take(message)

    async def run(self) -> None:
        """Do nothing for ever."""
        self.running += 1
        try:
            await asyncio.Event().wait()
        finally:
            self.running -= 1

    async def _change_mode(self, request: Fields, caller: Actor) -> Fields:
        if not isinstance(request.get("mode_name"), str):
            raise InvalidValueError("mode_name must be a text", "mode_name")
        self.asked.append((request, caller))
        await self.answer.wait()
        return {"success": True}

    async def _get_mode(self, request: Fields, caller: Actor) -> Fields:
        if self.is_broken:
            raise ZeroDivisionError
        return {"current_mode": "SLOW"}

    def _take(self, message: Fields, sender: Actor) -> None:
        if not isinstance(message.get("enabled"), bool):
            raise InvalidValueError("enabled must be true or false", "enabled")
        self.readings.append((message, sender))


def make_bridge(
    interface: SmallInterface, clock: ManualClock | None = None, calls_per_s: int = 1_000
) -> Bridge:
    """Return what clients share, over a small interface."""
    clock = clock or ManualClock()
    return Bridge(interface, FrameFeed(), clock, calls_per_s, RefusedReadings())


class Pipe(asyncio.WriteTransport):
    """A transport that takes as much as a test says."""

    def __init__(self) -> None:
        super().__init__()
        self.written: list[bytes] = []
        self.waiting = 0
        self.aborted = False

    @property
    def connection(self) -> Connection:
        """Return it as a server offers it."""
        return Connection(self, lambda _: None, lambda: None)

    def write(self, data: bytes | bytearray | memoryview) -> None:
        """Keep what is written."""
        self.written.append(bytes(data))

    def get_write_buffer_size(self) -> int:
        """Return what the test says."""
        return self.waiting

    def is_closing(self) -> bool:
        """Tell whether it was cut off."""
        return self.aborted

    def abort(self) -> None:
        """Note that it was cut off."""
        self.aborted = True


class RosbridgeClient(WebSocketClient):
    """A client of the route, in this process.

    Args:
        app: The application.
        headers: Of the handshake.
    """

    def __init__(self, app: ASGIApp, headers: Mapping[str, str] | None = None) -> None:
        super().__init__(app, "/rosbridge", headers)

    def ask(self, op: str, **members: object) -> None:
        """Send an operation."""
        self.send({"op": op, **members})

    async def next(self, op: str) -> dict[str, Any]:
        """Return the next message of an operation."""
        while True:
            found: dict[str, Any] = json.loads(await self.text())
            if found["op"] == op:
                return found
