import sys

import pytest

from service.files.source_block import SpiBlock
from service.sources.source import reason_of
from service.sources.spi import spi_source
from tests.support.manual_clock import ManualClock
from tests.support.sources import Device, fake_spidev


def test_zeros_are_sent_while_the_answer_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    device = Device()
    device.number = 512
    monkeypatch.setitem(sys.modules, "spidev", fake_spidev(device))
    blocks = {
        # MCP3008: the answer begins in the byte after the start bit.
        "adc": SpiBlock(bus=0, device=1, send=[1, 0x80], skip=1, bits=10, mode=0),
        "register": SpiBlock(bus=0, device=1, send=[0x83], mode=3, max_speed_hz=1_000_000),
    }
    adc, register = spi_source(ManualClock(), (0, 1), blocks).probes

    assert adc.read() == 512
    assert register.read() == 512
    assert device.opened == [(0, 1)]
    assert device.asked == [(0, 500_000, (1, 0x80, 0)), (3, 1_000_000, (0x83, 0, 0))]


def test_without_the_library_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "spidev", None)
    (probe,) = spi_source(ManualClock(), (0, 0), {"adc": SpiBlock(bus=0, send=[1])}).probes

    with pytest.raises(Exception, match="spidev") as caught:
        probe.read()
    assert "pip install 'pilothouse[spi]'" in reason_of(caught.value)
