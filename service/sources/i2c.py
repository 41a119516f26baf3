"""Registers of devices on an I2C bus."""

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

from domain.timebase import seconds
from service.clock import Clock
from service.files.source_block import I2cBlock
from service.sources.register import number_in
from service.sources.reopened import Reopened
from service.sources.sampled import Probe, SampledSource
from service.sources.source import from_extra

if TYPE_CHECKING:
    from smbus2 import SMBus


def i2c_source(clock: Clock, bus: int, blocks: Mapping[str, I2cBlock]) -> SampledSource:
    """Return the source of one bus, whose devices are read one after the other.

    Args:
        clock: Of the service.
        bus: Its number.
        blocks: The registers on it, by signal.
    """
    device = Reopened(partial(_open, bus))
    probes = [
        Probe(signal, seconds(block.period_s), partial(device.use, partial(_read, block)))
        for signal, block in blocks.items()
    ]
    return SampledSource(f"i2c {bus}", probes, clock, device.close)


def _open(bus: int) -> "SMBus":
    with from_extra("i2c"):
        from smbus2 import SMBus
    return SMBus(bus)


def _read(block: I2cBlock, bus: "SMBus") -> float:
    # One transfer, so that all bytes are of the same conversion of the device.
    data = bus.read_i2c_block_data(block.address, block.register_number, block.size_bytes)
    return number_in(bytes(data), block)
