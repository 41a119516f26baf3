"""What was heard in ROS on its way to the core: the emergency stop first, reports of nodes last."""

import asyncio
from enum import IntEnum

from domain.health.signals import ESTOP_SIGNAL
from domain.inputs import Readings, VehicleReport
from service.ports import BackendMessage, Deliver

_AT_ONCE = 5
"""So many are delivered before others get their turn."""


class _Urgency(IntEnum):
    """What goes first; within each, messages keep their order."""

    ESTOP = 0
    SENSORS = 1
    """All other readings, and the vehicle."""
    NODES = 2


class Delivery:
    """Delivers what was heard a few at a time, so that thousands of reports delay nobody.

    A reading of `estop` waits at most for what is being delivered when it is heard.
    """

    def __init__(self, room: int) -> None:
        """Make an empty one.

        Args:
            room: So many messages of each urgency may wait.
        """
        self._lanes = {urgency: asyncio.Queue[BackendMessage](room) for urgency in _Urgency}
        self._woken = asyncio.Event()

    def put(self, message: BackendMessage) -> None:
        """Take a message and return at once; on the event loop's thread.

        Raises:
            asyncio.QueueFull: There is no room for it.
        """
        self._lanes[_urgency(message)].put_nowait(message)
        self._woken.set()

    async def run(self, deliver: Deliver) -> None:
        """Deliver until cancelled, or until `deliver` raises."""
        while True:
            await self._woken.wait()
            for _ in range(_AT_ONCE):
                lane = next((lane for lane in self._lanes.values() if not lane.empty()), None)
                if lane is None:
                    self._woken.clear()
                    break
                deliver(lane.get_nowait())
            await asyncio.sleep(0)


def _urgency(message: BackendMessage) -> _Urgency:
    if isinstance(message, Readings):
        is_estop = any(reading.signal == ESTOP_SIGNAL for reading in message.items)
        return _Urgency.ESTOP if is_estop else _Urgency.SENSORS
    return _Urgency.SENSORS if isinstance(message, VehicleReport) else _Urgency.NODES
