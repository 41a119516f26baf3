"""Logs when a node becomes unreachable, is being restored, or cannot be restored."""

import asyncio
import logging

from domain.events.changes import NodeNotRestored, NodeRestoring
from domain.events.event import RecordedEvent
from domain.events.parts import NodeUnreachable
from service.event_log import EventLog, EventReader

log = logging.getLogger(__name__)

_LOGGED = (NodeUnreachable, NodeRestoring, NodeNotRestored)
_AT_ONCE = 100


async def log_node_incidents(events: EventLog) -> None:
    """Log incidents until cancelled. A simulation does not log them; its events show them."""
    reader, changed = EventReader(events), asyncio.Event()
    with events.watch(changed.set):
        while True:
            for event in reader.take(_AT_ONCE):
                if isinstance(event, RecordedEvent) and isinstance(event.event, _LOGGED):
                    log.warning("%s: %s", event.kind, event.event.words)
            if reader.is_behind:
                await asyncio.sleep(0)
                continue
            await changed.wait()
            changed.clear()
