"""All kinds of events by name, for the interface documents."""

from collections.abc import Iterator, Mapping
from types import ModuleType

from domain.events import (
    announcing,
    changes,
    devices,
    driving,
    health,
    lead,
    parts,
    processes,
    reactions,
    service,
    targets,
)
from domain.events.event import Event


def _kinds(*modules: ModuleType) -> Iterator[type[Event]]:
    for module in modules:
        for item in vars(module).values():
            if isinstance(item, type) and issubclass(item, Event) and hasattr(item, "kind"):
                yield item


_MODULES = (
    announcing,
    parts,
    changes,
    devices,
    health,
    driving,
    lead,
    processes,
    reactions,
    service,
    targets,
)

EVENTS: Mapping[str, type[Event]] = {
    kind.kind: kind for kind in sorted(_kinds(*_MODULES), key=lambda item: item.kind)
}
