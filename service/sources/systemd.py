"""Units of systemd: whether they are active or failed, and how often they were restarted."""

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

from domain.timebase import seconds
from service.clock import Clock
from service.files.source_block import SystemdBlock
from service.sources.reopened import Reopened
from service.sources.sampled import Probe, SampledSource
from service.sources.source import SourceError, from_extra

if TYPE_CHECKING:
    from service.sources.systemd_bus import ServiceManager

_ACTIVE = frozenset({"active", "reloading", "refreshing"})


def systemd_source(clock: Clock, manager: str, blocks: Mapping[str, SystemdBlock]) -> SampledSource:
    """Return the source of one service manager.

    Args:
        clock: Of the service.
        manager: `system` or `user`.
        blocks: What is asked of its units, by signal.
    """
    connection = Reopened(partial(_open, manager))
    probes = [
        Probe(signal, seconds(block.period_s), partial(connection.use, partial(_read, block)))
        for signal, block in blocks.items()
    ]
    return SampledSource(f"systemd {manager}", probes, clock, connection.close)


def _open(manager: str) -> "ServiceManager":
    with from_extra("systemd"):
        # Imported here, since sdbus is not installed on every machine.
        from service.sources.systemd_bus import ServiceManager
    return ServiceManager(manager)


def _read(block: SystemdBlock, manager: "ServiceManager") -> int:
    loaded, active = manager.states(block.unit)
    if loaded == "not-found":
        raise SourceError(f"there is no unit {block.unit}")
    if block.what == "restarts":
        return manager.restarts(block.unit)
    return int(active in _ACTIVE if block.what == "active" else active == "failed")
