"""Queues messages from ROS for the core: the emergency stop first, reports of nodes last."""

import asyncio
from collections import deque
from enum import IntEnum

from domain.controller import ControllerMessage
from domain.health.signals import ESTOP_SIGNAL
from domain.inputs import DriveStatus, Readings, ReportBacklog, VehicleReport
from domain.timebase import Instant, seconds
from service.clock import Clock
from service.ports import BackendMessage, Deliver

_AT_ONCE = 3
"""Messages delivered before other tasks of the event loop run."""
_SOURCE = "ROS nodes"
_TELL_EVERY = seconds(0.1)


class _Urgency(IntEnum):
    """Order of delivery; messages of the same urgency keep their order."""

    ESTOP = 0
    SENSORS = 1
    """All other readings, and reports of the vehicle and of whoever drives it."""
    NODES = 2


class Delivery:
    """Delivers a few messages at a time, so that thousands of reports block nothing else.

    A reading of `estop` waits at most for the message that is being delivered when it arrives.
    """

    def __init__(self, room: int, clock: Clock) -> None:
        """Make empty queues.

        Args:
            room: Capacity for messages of each urgency.
            clock: Of the service.
        """
        self._room = room
        self._clock = clock
        self._lanes = {urgency: deque[tuple[Instant, BackendMessage]]() for urgency in _Urgency}
        """Each message with the time at which it arrived."""
        self._woken = asyncio.Event()
        self._told: Instant | None = None

    def put(self, message: BackendMessage) -> None:
        """Queue a message and return at once; on the event loop's thread.

        Raises:
            asyncio.QueueFull: The queue is full.
        """
        lane = self._lanes[_urgency(message)]
        if len(lane) >= self._room:
            raise asyncio.QueueFull
        lane.append((self._clock.now(), message))
        self._woken.set()

    async def run(self, deliver: Deliver) -> None:
        """Deliver until cancelled, or until `deliver` raises.

        `ReportBacklog` tells of reports of nodes that wait for longer than a turn.
        """
        while True:
            await self._woken.wait()
            for _ in range(_AT_ONCE):
                lane = next((lane for lane in self._lanes.values() if lane), None)
                if lane is None:
                    self._woken.clear()
                    break
                deliver(lane.popleft()[1])
            self._tell_backlog(deliver)
            await asyncio.sleep(0)

    def _tell_backlog(self, deliver: Deliver) -> None:
        lane = self._lanes[_Urgency.NODES]
        # All before the oldest that waits is delivered; others may have come at the same instant.
        since = lane[0][0] - 1 if lane else None
        if since is None or self._told is None:
            is_news = since is not self._told
        else:
            is_news = since >= self._told + _TELL_EVERY
        if is_news:
            self._told = since
            deliver(ReportBacklog(_SOURCE, since))


def _urgency(message: BackendMessage) -> _Urgency:
    if isinstance(message, Readings):
        is_estop = any(reading.signal == ESTOP_SIGNAL for reading in message.items)
        return _Urgency.ESTOP if is_estop else _Urgency.SENSORS
    is_driving = isinstance(message, VehicleReport | DriveStatus | ControllerMessage)
    return _Urgency.SENSORS if is_driving else _Urgency.NODES
