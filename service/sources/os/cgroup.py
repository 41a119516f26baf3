"""Control groups, version 2: what the processes of one together use."""

import math
import os
from collections.abc import Callable
from pathlib import Path

from service.sources.os.files import numbers_in, pressure_percent
from service.sources.os.rates import Rate

ROOT = Path("/sys/fs/cgroup")
_PER_SECOND = 1e6
"""Of the microseconds in which the kernel counts."""


def root_of_groups(root: Path = ROOT) -> Path:
    """Return where version 2 is: on machines that use both versions, in a folder of its own."""
    hybrid = root / "unified"
    return hybrid if hybrid.is_dir() and not (root / "cgroup.controllers").exists() else root


class Group:
    """One control group. Its methods raise OSError if it is gone, or lacks a controller.

    Source: Linux, Documentation/admin-guide/cgroup-v2.rst.
    """

    def __init__(self, name: str, root: Path | None = None) -> None:
        self._name = name.strip("/")
        self._root = root
        self._cpu = Rate()

    def reader(self, what: str) -> Callable[[], float | None]:
        """Return what reads a quantity."""
        if what.endswith("_pressure_percent"):
            resource = what.removesuffix("_pressure_percent")
            return lambda: pressure_percent(self._folder / f"{resource}.pressure")
        readers: dict[str, Callable[[], float | None]] = {
            "cpu_percent": self._cpu_percent,
            "memory_percent": self._memory_percent,
            "memory_bytes": lambda: self._number("memory.current"),
            "processes": lambda: self._number("pids.current"),
            "oom_kills": lambda: numbers_in(self._folder / "memory.events")["oom_kill"],
        }
        return readers[what]

    @property
    def _folder(self) -> Path:
        return (root_of_groups() if self._root is None else self._root) / self._name

    def _cpu_percent(self) -> float | None:
        used = numbers_in(self._folder / "cpu.stat")["usage_usec"] / _PER_SECOND
        rate = self._cpu.per_second(used)
        return None if rate is None else 100.0 * rate / (os.cpu_count() or 1)

    def _memory_percent(self) -> float:
        """Return the share of the limit; of the memory of the machine, if there is no limit."""
        limit = min(self._number("memory.max"), _memory_of_machine())
        return 100.0 * self._number("memory.current") / limit

    def _number(self, name: str) -> float:
        text = (self._folder / name).read_text().strip()
        return math.inf if text == "max" else int(text)


def _memory_of_machine() -> int:
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
