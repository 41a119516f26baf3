from typing import Any

import pytest

from service.files.source_block import OsBlock
from service.sources.os.os_sources import os_sources
from tests.support.manual_clock import ManualClock


def sources(**blocks: dict[str, Any]) -> dict[str, tuple[str, ...]]:
    given = {signal: OsBlock.model_validate(block) for signal, block in blocks.items()}
    return {source.name: source.signals for source in os_sources(given, ManualClock())}


def test_what_may_block_is_read_apart_from_the_rest() -> None:
    assert sources(
        cpu={"what": "cpu_percent"},
        memory={"what": "memory_percent"},
        group={"what": "memory_bytes", "cgroup": "system.slice"},
        root={"what": "disk_percent"},
        share={"what": "disk_free_bytes", "path": "/mnt/share"},
        heat={"what": "temperature_celsius"},
        offset={"what": "clock_offset_s"},
        camera={"what": "memory_bytes", "process": "camera"},
        lidar={"what": "processes", "process": "lidar"},
    ) == {
        "os": ("cpu", "memory", "group"),
        "os disk /": ("root",),
        "os disk /mnt/share": ("share",),
        "os temperature": ("heat",),
        "os clock": ("offset",),
        "os processes": ("camera", "lidar"),
    }


@pytest.mark.parametrize(
    ("block", "period_s"),
    [
        ({"what": "cpu_percent"}, 1.0),
        ({"what": "disk_percent"}, 10.0),
        ({"what": "cpu_percent", "process": "camera"}, 10.0),
        ({"what": "disk_percent", "period_s": 0.5}, 0.5),
    ],
)
def test_what_is_costly_to_read_is_read_less_often(block: dict[str, Any], period_s: float) -> None:
    (source,) = os_sources({"a": OsBlock.model_validate(block)}, ManualClock())

    assert [probe.period for probe in source.probes] == [period_s * 1e9]
