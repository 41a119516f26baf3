"""Processes of a name: what they together use."""

import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Final

import psutil

from service.sources.os.rates import Rate
from service.sources.source import SourceError

_LONGEST_COMM: Final = 15
"""The kernel cuts off longer names; psutil takes the rest from the command line."""


_ENDED: Final = psutil.STATUS_ZOMBIE
"""Of a process whose parent has not asked yet how it ended."""


class Processes:
    """The processes of one name, found anew at each look: a node that crashed has a new one.

    Used by one thread: what psutil keeps between two looks is not made for several.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._known: dict[int, psutil.Process] = {}
        self._rates: dict[tuple[int, float], Rate] = {}
        """Of the CPU time, by process id and start."""

    def reader(self, what: str) -> Callable[[], float | None]:
        """Return what reads a quantity."""
        readers: dict[str, Callable[[], float | None]] = {
            "processes": lambda: float(len(self.found())),
            "cpu_percent": self._cpu_percent,
            "memory_percent": lambda: 100.0 * self._memory() / psutil.virtual_memory().total,
            "memory_bytes": self._memory,
            "threads": lambda: self._sum(lambda process: process.num_threads()),
            "open_files": lambda: self._sum(lambda process: process.num_fds()),
        }
        return readers[what]

    def found(self) -> list[psutil.Process]:
        """Return the processes, each the same object as before."""
        found = {}
        for pid in psutil.pids():
            if comm_of(pid) == self._name[:_LONGEST_COMM]:
                with suppress(psutil.NoSuchProcess):
                    known = self._known.get(pid)
                    process = known if known and known.is_running() else psutil.Process(pid)
                    if process.name() == self._name and process.status() != _ENDED:
                        found[pid] = process
        self._known = found
        return list(found.values())

    def _some(self) -> list[psutil.Process]:
        """Return the processes.

        Raises:
            SourceError: There is none: no data, which is not a bad value.
        """
        found = self.found()
        if not found:
            raise SourceError(f"no process is named {self._name}")
        return found

    def _sum(self, of: Callable[[psutil.Process], float]) -> float:
        return sum(_without_ended(of, self._some()))

    def _memory(self) -> float:
        """Return the proportional share of memory: what is shared counts once for all of them."""
        return self._sum(_pss)

    def _cpu_percent(self) -> float | None:
        found = self._some()
        keys = [(process.pid, process.create_time()) for process in found]
        self._rates = {key: self._rates.get(key) or Rate() for key in keys}
        rates = []
        for key, process in zip(keys, found, strict=True):
            for used_s in _without_ended(_cpu_s, [process]):
                rate = self._rates[key].per_second(used_s)
                if rate is not None:
                    rates.append(rate)
        return 100.0 * sum(rates) / (os.cpu_count() or 1) if rates else None


def _without_ended(
    of: Callable[[psutil.Process], float], processes: Iterable[psutil.Process]
) -> Iterable[float]:
    """Yield a quantity of processes, except those that end meanwhile."""
    for process in processes:
        try:
            yield of(process)
        except psutil.NoSuchProcess:
            continue
        except psutil.AccessDenied as error:
            raise SourceError(f"process {process.pid} belongs to another user") from error


def comm_of(pid: int) -> str:
    """Return the name of a process, at a tenth of the cost of asking psutil; empty: it ended."""
    try:
        return Path(f"/proc/{pid}/comm").read_text(errors="replace").rstrip("\n")
    except OSError:
        return ""


def _cpu_s(process: psutil.Process) -> float:
    times = process.cpu_times()
    return times.user + times.system


def _pss(process: psutil.Process) -> float:
    return float(process.memory_full_info().pss)
