"""Logs what happens to nodes on its own: lost, being restored, not restored."""

import asyncio
import logging

from domain.events import Event
from service.event_log import EventLog, EventReader

log = logging.getLogger(__name__)

KINDS = frozenset({"node.unreachable", "node.restoring", "node.not_restored"})
_AT_ONCE = 100


async def log_node_incidents(events: EventLog) -> None:
    """Log what comes, until cancelled; a simulation has its events, and nobody who does this."""
    reader, changed = EventReader(events), asyncio.Event()
    with events.watch(changed.set):
        while True:
            for event in reader.take(_AT_ONCE):
                if isinstance(event, Event) and event.kind in KINDS:
                    log.warning("%s: %s", event.kind, _words(event))
            if reader.is_behind:
                await asyncio.sleep(0)
                continue
            await changed.wait()
            changed.clear()


def _words(event: Event) -> str:
    return ", ".join(f"{name} {value}" for name, value in event.data.items())
