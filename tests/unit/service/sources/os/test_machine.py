"""The machine, with what psutil tells of it in the hands of a test."""

import os
from collections import namedtuple
from types import SimpleNamespace
from typing import Any

import psutil
import pytest

from service.files.source_block import OsBlock
from service.sources.os.machine import reader_of
from service.sources.os.rates import Rate
from service.sources.source import SourceError

Times = namedtuple("Times", "user nice system idle iowait guest guest_nice")
Net = namedtuple(
    "Net", "bytes_sent bytes_recv packets_sent packets_recv errin errout dropin dropout"
)
Temperature = namedtuple("Temperature", "label current high critical")


def reads(what: str, **settings: object) -> Any:  # noqa: ANN401  # None, or a number
    return reader_of(OsBlock.model_validate({"what": what, **settings}))()


def test_the_processors_are_busy_while_they_are_not_idle(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Waiting for a disk is idle, and the time of guests is in that of users already."""
    looks = iter(
        [Times(100, 0, 0, 900, 0, 50, 0), Times(140, 0, 10, 930, 20, 70, 0), Times(*([0] * 7))]
    )
    monkeypatch.setattr(psutil, "cpu_times", lambda: next(looks))
    read = reader_of(OsBlock(what="cpu_percent"))

    assert read() is None
    assert read() == 50.0
    assert read() is None


@pytest.mark.parametrize(("what", "load"), [("load_1", 3.0), ("load_5", 2.0), ("load_15", 1.0)])
def test_the_load_of_the_last_minutes(
    monkeypatch: pytest.MonkeyPatch, what: str, load: float
) -> None:
    monkeypatch.setattr(os, "getloadavg", lambda: (3.0, 2.0, 1.0))
    monkeypatch.setattr(os, "cpu_count", lambda: 4)

    assert reads(what) == load
    assert reads("load_per_core") == 0.75


def test_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    memory = SimpleNamespace(total=1_000, available=400, percent=60.0)
    monkeypatch.setattr(psutil, "virtual_memory", lambda: memory)
    monkeypatch.setattr(psutil, "swap_memory", lambda: SimpleNamespace(percent=5.0))

    assert reads("memory_percent") == 60.0
    assert reads("memory_bytes") == 600
    assert reads("memory_available_bytes") == 400
    assert reads("swap_percent") == 5.0


@pytest.mark.parametrize(
    ("what", "of_all", "of_eth0"),
    [
        ("network_received_bytes_per_s", 300.0, 100.0),
        ("network_sent_bytes_per_s", 30.0, 10.0),
        ("network_errors_per_s", 9.0, 3.0),
        ("network_drops_per_s", 21.0, 7.0),
    ],
)
def test_the_network_without_the_loopback_interface(
    monkeypatch: pytest.MonkeyPatch, what: str, of_all: float, of_eth0: float
) -> None:
    counted = Net(10, 100, 0, 0, 1, 2, 3, 4)
    nothing = Net(*[0] * 8)
    looks = iter(
        [
            {"lo": nothing, "eth0": nothing, "can0": nothing},
            {
                "lo": Net(*[9_999] * 8),
                "eth0": counted,
                "can0": Net(*(2 * count for count in counted)),
            },
        ]
        * 2
    )
    monkeypatch.setattr(psutil, "net_io_counters", lambda **_: next(looks))
    times = iter([0.0, 1.0] * 2)
    monkeypatch.setattr("service.sources.os.machine.Rate", lambda: Rate(lambda: next(times)))

    whole, one = (
        reader_of(OsBlock.model_validate({"what": what, **named}))
        for named in ({}, {"interface": "eth0"})
    )
    assert (whole(), whole()) == (None, of_all)
    assert (one(), one()) == (None, of_eth0)


def test_an_interface_that_is_not_there_is_no_bad_value(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(psutil, "net_io_counters", lambda **_: {})
    monkeypatch.setattr(psutil, "net_if_stats", dict)

    for what in ("network_sent_bytes_per_s", "network_up"):
        with pytest.raises(SourceError, match="there is no interface wlan0"):
            reads(what, interface="wlan0")


def test_an_interface_is_up_or_not(monkeypatch: pytest.MonkeyPatch) -> None:
    states = {"eth0": SimpleNamespace(isup=True), "can0": SimpleNamespace(isup=False)}
    monkeypatch.setattr(psutil, "net_if_stats", lambda: states)

    assert reads("network_up", interface="eth0") == 1
    assert reads("network_up", interface="can0") == 0


@pytest.mark.parametrize(
    ("sensor", "degrees"), [(None, 71.0), ("coretemp", 60.0), ("Core 1", 60.0), ("nvme", 71.0)]
)
def test_the_hottest_sensor_of_a_name(
    monkeypatch: pytest.MonkeyPatch, sensor: str | None, degrees: float
) -> None:
    found = {
        "coretemp": [
            Temperature("Core 0", 55.0, None, None),
            Temperature("Core 1", 60.0, None, None),
        ],
        "nvme": [Temperature("", 71.0, None, None)],
    }
    monkeypatch.setattr(psutil, "sensors_temperatures", lambda: found, raising=False)

    assert reads("temperature_celsius", sensor=sensor) == degrees


def test_a_machine_without_sensors_has_no_temperature(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(psutil, "sensors_temperatures", raising=False)

    with pytest.raises(SourceError, match="no temperature sensor"):
        reads("temperature_celsius")
    with pytest.raises(SourceError, match="no sensor GPU"):
        reads("temperature_celsius", sensor="GPU")


def test_a_disk_is_full_for_users_before_it_is_for_root(monkeypatch: pytest.MonkeyPatch) -> None:
    disk = SimpleNamespace(f_blocks=100, f_bfree=30, f_bavail=20, f_frsize=4_096)
    monkeypatch.setattr(os, "statvfs", lambda _: disk)

    assert reads("disk_percent", path="/data") == pytest.approx(100 * 70 / 90)
    assert reads("disk_free_bytes", path="/data") == 20 * 4_096


def test_a_folder_on_no_disk_has_no_share(monkeypatch: pytest.MonkeyPatch) -> None:
    disk = SimpleNamespace(f_blocks=0, f_bfree=0, f_bavail=0, f_frsize=4_096)
    monkeypatch.setattr(os, "statvfs", lambda _: disk)

    with pytest.raises(SourceError, match="no disk"):
        reads("disk_percent", path="/proc")


@pytest.mark.skipif(not os.path.exists("/proc/meminfo"), reason="needs Linux")
@pytest.mark.parametrize(
    "what",
    ["load_1", "memory_percent", "memory_bytes", "memory_available_bytes", "disk_percent"],
)
def test_this_machine_can_be_read(what: str) -> None:
    assert reads(what) >= 0
