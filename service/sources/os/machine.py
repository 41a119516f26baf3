"""The machine: its processors, memory, pressure, network, temperatures and disks."""

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Final

import psutil

from service.files.source_block import OsBlock
from service.sources.os.files import pressure_percent
from service.sources.os.rates import Rate
from service.sources.source import SourceError

_PRESSURE = Path("/proc/pressure")
_LOADS: Final = {"load_1": 0, "load_5": 1, "load_15": 2}


class CpuPercent:
    """The share of time in which the processors were busy, from one look to the next."""

    def __init__(self) -> None:
        self._last: tuple[float, float] | None = None

    def __call__(self) -> float | None:
        """Return the share in percent; None: this is the first look."""
        times: dict[str, float] = psutil.cpu_times()._asdict()
        # The times of guests are in `user` and `nice`, too.
        total = sum(times.values()) - times.get("guest", 0.0) - times.get("guest_nice", 0.0)
        idle = times["idle"] + times.get("iowait", 0.0)
        last, self._last = self._last, (total, idle)
        if last is None or total <= last[0]:
            return None
        return min(max(100.0 * (1.0 - (idle - last[1]) / (total - last[0])), 0.0), 100.0)


class NetworkRate:
    """The rate of a counter of one interface, or of all but the loopback interface."""

    def __init__(self, what: str, interface: str | None) -> None:
        self._counters = _COUNTERS[what]
        self._interface = interface
        self._rate = Rate()

    def __call__(self) -> float | None:
        """Return the rate per second; None: this is the first look."""
        found = psutil.net_io_counters(pernic=True, nowrap=False)
        if self._interface is not None:
            if self._interface not in found:
                raise SourceError(f"there is no interface {self._interface}")
            found = {self._interface: found[self._interface]}
        else:
            found.pop("lo", None)
        names = self._counters
        total = sum(getattr(counters, name) for counters in found.values() for name in names)
        return self._rate.per_second(total)


_COUNTERS: Final = {
    "network_received_bytes_per_s": ("bytes_recv",),
    "network_sent_bytes_per_s": ("bytes_sent",),
    "network_errors_per_s": ("errin", "errout"),
    "network_drops_per_s": ("dropin", "dropout"),
}


def reader_of(block: OsBlock) -> Callable[[], float | None]:
    """Return what reads a quantity of the machine."""
    what = block.what
    if what in _LOADS:
        return lambda: os.getloadavg()[_LOADS[what]]
    if what.endswith("_pressure_percent"):
        path = _PRESSURE / what.removesuffix("_pressure_percent")
        return partial(pressure_percent, path)
    if what in _COUNTERS:
        return NetworkRate(what, block.interface)
    readers: dict[str, Callable[[], float | None]] = {
        "cpu_percent": CpuPercent(),
        "load_per_core": lambda: os.getloadavg()[0] / (os.cpu_count() or 1),
        "memory_percent": lambda: psutil.virtual_memory().percent,
        "memory_bytes": _memory_in_use,
        "memory_available_bytes": lambda: psutil.virtual_memory().available,
        "swap_percent": lambda: psutil.swap_memory().percent,
        "network_up": partial(_is_up, block.interface or ""),
        "temperature_celsius": partial(_temperature, block.sensor),
        "disk_percent": partial(_disk_percent, block.path),
        "disk_free_bytes": partial(_disk_free, block.path),
    }
    return readers[what]


def _memory_in_use() -> float:
    memory = psutil.virtual_memory()
    return float(memory.total - memory.available)


def _is_up(interface: str) -> float:
    stats = psutil.net_if_stats().get(interface)
    if stats is None:
        raise SourceError(f"there is no interface {interface}")
    return float(stats.isup)


def _temperature(sensor: str | None) -> float:
    # Only where the kernel has sensors: Linux and FreeBSD.
    read = getattr(psutil, "sensors_temperatures", dict)
    found = [
        (name, label, current)
        for name, entries in read().items()
        for label, current, *_ in entries
        if sensor is None or sensor in (name, label)
    ]
    if not found:
        raise SourceError("no temperature sensor" if sensor is None else f"no sensor {sensor}")
    return float(max(current for _, _, current in found))


def _disk_percent(path: str) -> float:
    """Return the share in use of what users without privileges can use, as `df` does."""
    disk = os.statvfs(path)
    used = disk.f_blocks - disk.f_bfree
    usable = used + disk.f_bavail
    if usable <= 0:
        raise SourceError(f"{path} is on no disk")
    return 100.0 * used / usable


def _disk_free(path: str) -> float:
    disk = os.statvfs(path)
    return float(disk.f_bavail * disk.f_frsize)
