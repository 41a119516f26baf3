"""Lists what is offered in a ROS graph, for the log."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

MAX_PARTS = 20
"""Parts that are listed; a robot may have a thousand, and they offer the same."""

Named: TypeAlias = dict[str, str]
"""Types by full name."""


@dataclass(frozen=True, slots=True)
class OfferedNames:
    """Names and types of what is offered, as they are in the graph."""

    services: Named = field(default_factory=dict)
    published: Named = field(default_factory=dict)
    subscribed: Named = field(default_factory=dict)

    def lines(self, parts: Collection[str]) -> Iterator[str]:
        """Yield a line for each part, after those for what belongs to the robot as a whole.

        Args:
            parts: Names of the parts, without the leading slash.
        """
        of_robot = (
            ("services", self.services),
            ("publishes", self.published),
            ("subscribes to", self.subscribed),
        )
        prefixes = {f"/{part}": None for part in parts}
        for what, named in of_robot:
            own = [f"{n} [{t}]" for n, t in sorted(named.items()) if _prefix(n) not in prefixes]
            if own:
                yield f"{what}: {', '.join(own)}"
        services, topics = _by_prefix(self.services), _by_prefix(self.published)
        found = [prefix for prefix in prefixes if prefix in services or prefix in topics]
        for prefix in found[:MAX_PARTS]:
            of_part = ", ".join(sorted(services.get(prefix, ())))
            told = ", ".join(sorted(topics.get(prefix, ())))
            yield f"{prefix}: services {of_part or 'none'}; publishes {told or 'nothing'}"
        if len(found) > MAX_PARTS:
            yield f"and {len(found) - MAX_PARTS} more parts, which offer the same"


def _prefix(name: str) -> str:
    return name.rpartition("/")[0]


def _by_prefix(named: Named) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for name in named:
        prefix, _, last = name.rpartition("/")
        found.setdefault(prefix, []).append(last)
    return found
