import inspect
import sys

import pytest

from service.files.source_block import GpioBlock
from service.sources.gpio import gpio_source
from service.sources.source import reason_of
from tests.support.manual_clock import ManualClock
from tests.support.sources import Device, fake_gpiod

CHIP = "/dev/gpiochip0"


def test_each_line_is_requested_as_an_input_with_its_own_settings(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    device = Device()
    gpiod, line = fake_gpiod(device)
    monkeypatch.setitem(sys.modules, "gpiod", gpiod)
    monkeypatch.setitem(sys.modules, "gpiod.line", line)
    blocks = {
        "estop": GpioBlock(line=17, active_low=True, bias="pull_up"),
        "door": GpioBlock(line="DOOR"),
    }
    source = gpio_source(ManualClock(), CHIP, blocks)
    estop, door = source.probes
    assert (estop.read(), door.read()) == (0, 0)
    device.number = 1
    assert (estop.read(), door.read()) == (1, 1)

    assert device.asked == [17, "DOOR"] * 2
    assert device.opened == [
        (
            CHIP,
            "pilothouse",
            {17: {"direction": "input", "active_low": True, "bias": "up"}},
        ),
        (
            CHIP,
            "pilothouse",
            {"DOOR": {"direction": "input", "active_low": False, "bias": "as is"}},
        ),
    ]


@pytest.mark.parametrize("missing", ["gpiod", "gpiod.line"])
def test_without_the_library_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, missing: str
) -> None:
    """Version 1 has no `gpiod.line`."""
    monkeypatch.setitem(sys.modules, missing, None)
    (probe,) = gpio_source(ManualClock(), CHIP, {"estop": GpioBlock(line=1)}).probes

    with pytest.raises(Exception, match="gpiod") as caught:
        probe.read()
    assert "pip install 'pilothouse[gpio]'" in reason_of(caught.value)


def test_the_library_is_called_as_it_wants() -> None:
    gpiod = pytest.importorskip("gpiod")
    line = pytest.importorskip("gpiod.line")

    settings = gpiod.LineSettings(
        direction=line.Direction.INPUT, active_low=True, bias=line.Bias["PULL_UP"]
    )
    inspect.signature(gpiod.request_lines).bind(CHIP, consumer="p", config={17: settings})
    assert {"AS_IS", "DISABLED", "PULL_UP", "PULL_DOWN"} <= set(line.Bias.__members__)
    assert hasattr(line.Value, "ACTIVE")
    assert hasattr(gpiod.LineRequest, "get_value")
    assert hasattr(gpiod.LineRequest, "release")
