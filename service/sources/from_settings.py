"""The sources that a robot file describes."""

from collections import defaultdict
from collections.abc import Callable, Hashable, Iterator, Mapping
from functools import partial
from typing import TypeVar

from service.clock import Clock
from service.files.robot_file import RobotSettings
from service.sources.gpio import gpio_source
from service.sources.i2c import i2c_source
from service.sources.number_file import file_source
from service.sources.source import Source
from service.sources.sources import Sources
from service.sources.spi import spi_source
from service.sources.systemd import systemd_source

BlockT = TypeVar("BlockT")
KeyT = TypeVar("KeyT", bound=Hashable)


def make_sources(robot: RobotSettings, clock: Clock) -> Sources | None:
    """Return the sources of a robot, none of which is open yet; None: it has none.

    Signals that are posted have no source here.
    """
    sources = tuple(_sources(robot, clock))
    if not sources:
        return None
    specs = {signal.spec.name: signal.spec for signal in robot.to_signal_settings()}
    return Sources(sources, specs, clock)


def _sources(robot: RobotSettings, clock: Clock) -> Iterator[Source]:
    blocks = robot.signals.sources
    if of_os := {name: block.os for name, block in blocks.items() if block.os is not None}:
        # Imported here, since psutil is large, and needed only then.
        from service.sources.os.os_sources import os_sources

        yield from os_sources(of_os, clock)
    yield from _grouped(
        {name: block.file for name, block in blocks.items() if block.file},
        lambda file: file.path,
        partial(file_source, clock),
    )
    yield from _grouped(
        {name: block.systemd for name, block in blocks.items() if block.systemd},
        lambda unit: unit.manager,
        partial(systemd_source, clock),
    )
    yield from _grouped(
        {name: block.gpio for name, block in blocks.items() if block.gpio},
        lambda line: line.chip,
        partial(gpio_source, clock),
    )
    yield from _grouped(
        {name: block.i2c for name, block in blocks.items() if block.i2c},
        lambda register: register.bus,
        partial(i2c_source, clock),
    )
    yield from _grouped(
        {name: block.spi for name, block in blocks.items() if block.spi},
        lambda number: (number.bus, number.device),
        partial(spi_source, clock),
    )


def _grouped(
    blocks: Mapping[str, BlockT],
    key_of: Callable[[BlockT], KeyT],
    make: Callable[[KeyT, Mapping[str, BlockT]], Source],
) -> Iterator[Source]:
    """Yield a source for each group of blocks that one thread reads."""
    groups = defaultdict[KeyT, dict[str, BlockT]](dict)
    for signal, block in blocks.items():
        groups[key_of(block)][signal] = block
    for key, group in groups.items():
        yield make(key, group)
