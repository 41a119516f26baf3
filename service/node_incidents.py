"""Logs when a node or a device becomes unreachable, and when a node is restored or cannot be."""

import asyncio
import logging

from domain.events.changes import NodeNotRestored, NodeRestoring
from domain.events.devices import DeviceConflict, DeviceLost
from domain.events.event import Event, RecordedEvent
from domain.events.parts import NodeUnreachable
from service.event_log import EventLog, EventReader

log = logging.getLogger(__name__)

_LOGGED = (NodeUnreachable, NodeRestoring, NodeNotRestored, DeviceLost, DeviceConflict)
_AT_ONCE = 100


async def log_node_incidents(events: EventLog) -> None:
    """Log incidents until cancelled. A simulation does not log them; its events show them."""
    reader, changed = EventReader(events), asyncio.Event()
    with events.watch(changed.set):
        while True:
            for event in reader.take(_AT_ONCE):
                if isinstance(event, RecordedEvent) and _is_incident(event.event):
                    log.warning("%s: %s", event.kind, event.event.words)
            if reader.is_behind:
                await asyncio.sleep(0)
                continue
            await changed.wait()
            changed.clear()


def _is_incident(event: Event) -> bool:
    """Tell whether an event is logged; of nodes that are lost with their device, that one is."""
    return isinstance(event, _LOGGED) and event.notable
