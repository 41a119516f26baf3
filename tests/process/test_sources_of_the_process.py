"""Sources that hang, lie, raise or are missing, in the real process, harm no other."""

import signal
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.support.process import service
from tests.support.waiting import until

HANGS = """\
import time


class SMBus:
    def __init__(self, bus):
        pass

    def read_i2c_block_data(self, *arguments):
        time.sleep(3_600)

    def close(self):
        pass
"""
RAISES = """\
class SpiDev:
    def open(self, *place):
        raise RuntimeError("the driver is out of its mind")
"""
ROBOT = """\
signals:
  hangs: {{source: {{i2c: {{bus: 1, address: 0x40, register: 2}}}}}}
  raises: {{source: {{spi: {{bus: 0, send: [1]}}}}}}
  lies: {{source: {{file: {{path: {folder}/lies, period_s: 0.1}}}}}}
  missing: {{source: {{file: {{path: {folder}/missing, period_s: 0.1}}}}}}
  good: {{stale_after_s: 10, source: {{file: {{path: {folder}/good, period_s: 0.1}}}}}}
"""


async def test_what_is_wrong_with_one_source_harms_no_other_and_does_not_delay_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "smbus2.py").write_text(HANGS)
    (tmp_path / "spidev.py").write_text(RAISES)
    (tmp_path / "lies").write_text("1e400")
    (tmp_path / "good").write_text("42")
    robot = tmp_path / "robot.yaml"
    robot.write_text(ROBOT.format(folder=tmp_path))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with service("--robot", str(robot)) as running:
        async with httpx.AsyncClient(base_url=running.url) as http:

            async def signals() -> dict[str, dict[str, Any]]:
                items = (await http.get("/signals")).json()["items"]
                return {item["signal"]: item for item in items}

            async def all_are_told() -> bool:
                seen = await signals()
                faults = [seen[name]["source_fault"] for name in ("hangs", "raises", "missing")]
                return None not in faults and seen["good"]["value"] is not None

            await until(all_are_told, 0.05)
            seen = await signals()
            assert seen["good"]["value"] == 42
            assert not seen["good"]["stale"]
            assert seen["hangs"]["source_fault"] == "no answer within 1 s"
            assert seen["raises"]["source_fault"] == "the driver is out of its mind"
            assert "finite number" in seen["lies"]["source_fault"]
            assert "No such file" in seen["missing"]["source_fault"]
            assert (await http.get("/readyz")).status_code == 200

            (tmp_path / "lies").write_text("7")

            async def lies_no_longer() -> bool:
                return bool((await signals())["lies"]["value"] == 7)

            await until(lies_no_longer, 0.05)
        running.send_signal(signal.SIGTERM)
        code, _, complaints = running.ended(within_s=10.0)

    assert code == 0
    assert "Traceback" not in complaints
