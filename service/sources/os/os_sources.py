"""The sources of the computer: what may block each has a thread of its own."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping

from domain.timebase import seconds
from service.clock import Clock
from service.files.source_block import OsBlock
from service.sources.os.cgroup import Group
from service.sources.os.clock_offset import clock_offset_s
from service.sources.os.machine import reader_of
from service.sources.os.processes import Processes
from service.sources.sampled import Probe, SampledSource

_Read = Callable[[], float | None]


def os_sources(blocks: Mapping[str, OsBlock], clock: Clock) -> Iterator[SampledSource]:
    """Yield the sources of the computer.

    Args:
        blocks: The quantities, by signal.
        clock: Of the service.
    """
    probes = defaultdict[str, list[Probe]](list)
    for signal, block in blocks.items():
        probe = Probe(signal, seconds(block.seconds_between), _reader(block))
        probes[_thread_of(block)].append(probe)
    for name, some in probes.items():
        yield SampledSource(name, some, clock)


def _thread_of(block: OsBlock) -> str:
    """Return the source that a quantity belongs to.

    A disk of the network can block for ever, a sensor behind a slow bus for a while, and processes
    are many.
    """
    if block.process is not None:
        return "os processes"
    if block.what.startswith("disk_"):
        return f"os disk {block.path}"
    if block.what == "temperature_celsius":
        return "os temperature"
    return "os clock" if block.what == "clock_offset_s" else "os"


def _reader(block: OsBlock) -> _Read:
    if block.process is not None:
        return Processes(block.process).reader(block.what)
    if block.cgroup is not None:
        return Group(block.cgroup).reader(block.what)
    return clock_offset_s if block.what == "clock_offset_s" else reader_of(block)
