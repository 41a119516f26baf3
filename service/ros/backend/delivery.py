"""Queues messages from ROS for the core: the emergency stop first, reports of nodes last."""

import asyncio
from enum import IntEnum

from domain.health.signals import ESTOP_SIGNAL
from domain.inputs import DriveStatus, NodesBehind, Readings, VehicleReport
from service.ports import BackendMessage, Deliver

_AT_ONCE = 5
"""Messages delivered before other tasks of the event loop run."""


class _Urgency(IntEnum):
    """Order of delivery; messages of the same urgency keep their order."""

    ESTOP = 0
    SENSORS = 1
    """All other readings, and reports of the vehicle and of what drives it."""
    NODES = 2


class Delivery:
    """Delivers a few messages at a time, so that thousands of reports block nothing else.

    A reading of `estop` waits at most for the message that is being delivered when it arrives.
    """

    def __init__(self, room: int) -> None:
        """Make empty queues.

        Args:
            room: Capacity for messages of each urgency.
        """
        self._lanes = {urgency: asyncio.Queue[BackendMessage](room) for urgency in _Urgency}
        self._woken = asyncio.Event()

    def put(self, message: BackendMessage) -> None:
        """Queue a message and return at once; on the event loop's thread.

        Raises:
            asyncio.QueueFull: The queue is full.
        """
        self._lanes[_urgency(message)].put_nowait(message)
        self._woken.set()

    async def run(self, deliver: Deliver) -> None:
        """Deliver until cancelled, or until `deliver` raises.

        `NodesBehind` tells whether more messages of nodes wait than one turn delivers.
        """
        behind = False
        while True:
            await self._woken.wait()
            for _ in range(_AT_ONCE):
                lane = next((lane for lane in self._lanes.values() if not lane.empty()), None)
                if lane is None:
                    self._woken.clear()
                    break
                deliver(lane.get_nowait())
            if behind is self._lanes[_Urgency.NODES].empty():
                behind = not behind
                deliver(NodesBehind(behind))
            await asyncio.sleep(0)


def _urgency(message: BackendMessage) -> _Urgency:
    if isinstance(message, Readings):
        is_estop = any(reading.signal == ESTOP_SIGNAL for reading in message.items)
        return _Urgency.ESTOP if is_estop else _Urgency.SENSORS
    is_driving = isinstance(message, VehicleReport | DriveStatus)
    return _Urgency.SENSORS if is_driving else _Urgency.NODES
