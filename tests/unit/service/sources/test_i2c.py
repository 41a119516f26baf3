import inspect
import sys

import pytest

from service.files.source_block import I2cBlock
from service.sources.i2c import i2c_source
from service.sources.source import reason_of
from tests.support.manual_clock import ManualClock
from tests.support.sources import Device, fake_smbus2


def block(**settings: object) -> I2cBlock:
    return I2cBlock.model_validate({"bus": 1, "address": 0x40, "register": 2} | settings)


def test_a_register_is_read_in_one_transfer(monkeypatch: pytest.MonkeyPatch) -> None:
    device = Device()
    device.number = 0x5DC2
    monkeypatch.setitem(sys.modules, "smbus2", fake_smbus2(device))
    blocks = {"voltage": block(shift=3, scale=0.004), "current": block(register=4)}
    voltage, current = i2c_source(ManualClock(), 1, blocks).probes

    assert voltage.read() == pytest.approx(12.0)
    assert current.read() == 0x5DC2
    assert device.opened == [1], "one bus for both"
    assert device.asked == [(0x40, 2, 2), (0x40, 4, 2)]


def test_without_the_library_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "smbus2", None)
    (probe,) = i2c_source(ManualClock(), 1, {"voltage": block()}).probes

    with pytest.raises(Exception, match="smbus2") as caught:
        probe.read()
    assert "pip install 'pilothouse[i2c]'" in reason_of(caught.value)


def test_the_library_is_called_as_it_wants() -> None:
    smbus2 = pytest.importorskip("smbus2")

    inspect.signature(smbus2.SMBus.read_i2c_block_data).bind(None, 0x40, 2, 2)
    inspect.signature(smbus2.SMBus).bind(1)
