"""Numbers from devices on an SPI bus."""

from collections.abc import Mapping
from functools import partial
from typing import Protocol

from domain.timebase import seconds
from service.clock import Clock
from service.files.source_block import SpiBlock
from service.sources.register import number_in
from service.sources.reopened import Reopened
from service.sources.sampled import Probe, SampledSource
from service.sources.source import from_extra


class SpiDevice(Protocol):
    """What is used of `spidev.SpiDev`, which has no types."""

    mode: int
    max_speed_hz: int

    def open(self, bus: int, device: int) -> None:
        """Open a device."""
        ...

    def xfer2(self, values: list[int]) -> list[int]:
        """Send bytes, and return those that were received meanwhile."""
        ...

    def close(self) -> None:
        """Close the device."""
        ...


def spi_source(
    clock: Clock, place: tuple[int, int], blocks: Mapping[str, SpiBlock]
) -> SampledSource:
    """Return the source of one device.

    Args:
        clock: Of the service.
        place: Numbers of the bus and of the device on it.
        blocks: What is read from it, by signal.
    """
    device = Reopened(partial(_open, place))
    probes = [
        Probe(signal, seconds(block.period_s), partial(device.use, partial(_read, block)))
        for signal, block in blocks.items()
    ]
    return SampledSource(f"spi {place[0]}.{place[1]}", probes, clock, device.close)


def _open(place: tuple[int, int]) -> SpiDevice:
    with from_extra("spi"):
        from spidev import SpiDev
    device: SpiDevice = SpiDev()
    device.open(*place)
    return device


def _read(block: SpiBlock, device: SpiDevice) -> float:
    device.mode, device.max_speed_hz = block.mode, block.max_speed_hz
    skip = len(block.send) if block.skip is None else block.skip
    zeros = max(0, skip + block.size_bytes - len(block.send))
    received = device.xfer2([*block.send, *[0] * zeros])
    return number_in(bytes(received[skip : skip + block.size_bytes]), block)
