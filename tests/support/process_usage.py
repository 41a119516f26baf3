"""What a process and its children use, as Linux tells it in /proc."""

import os
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_PROC = Path("/proc")
_CLOCK_HZ = os.sysconf("SC_CLK_TCK")


class ProcessUsage:
    """The use of a process with all of its threads and descendants.

    Args:
        pid: Of the process.
    """

    def __init__(self, pid: int) -> None:
        self._pid = pid

    def cpu_s(self) -> float:
        """Return the processor time so far, of user and system."""
        ticks = 0
        for pid in self._pids():
            with suppress(FileNotFoundError, ProcessLookupError):
                fields = _stat(pid)
                ticks += int(fields[11]) + int(fields[12])
        return ticks / _CLOCK_HZ

    def loop_cpu_s(self) -> float:
        """Return the processor time of the main thread, in which the event loop runs."""
        path = _PROC / str(self._pid) / "task" / str(self._pid) / "schedstat"
        return int(path.read_text().split()[0]) / 1e9

    def figures(self) -> dict[str, float]:
        """Return the memory of the process and of all, and how many they are.

        In PSS a page that several processes have is divided among them.
        """
        used: dict[int, tuple[dict[str, float], int]] = {}
        for pid in self._pids():
            # A worker may end at any moment.
            with suppress(FileNotFoundError, ProcessLookupError):
                used[pid] = _memory_mb(pid), int(_stat(pid)[17])
        return {
            "RSS_mb": round(used[self._pid][0]["Rss:"], 1),
            "RSS_of_all_mb": round(sum(memory["Rss:"] for memory, _ in used.values()), 1),
            "PSS_of_all_mb": round(sum(memory["Pss:"] for memory, _ in used.values()), 1),
            "processes": len(used),
            "threads": sum(threads for _, threads in used.values()),
        }

    def _pids(self) -> Iterator[int]:
        """Yield the process and everything below it."""
        children: dict[int, list[int]] = defaultdict(list)
        for entry in _PROC.iterdir():
            if entry.name.isdecimal():
                try:
                    parent = int(_stat(int(entry.name))[1])
                except (FileNotFoundError, ProcessLookupError):
                    continue
                children[parent].append(int(entry.name))
        waiting = [self._pid]
        while waiting:
            pid = waiting.pop()
            yield pid
            waiting += children[pid]


def first_and_last_core() -> tuple[int, int]:
    """Return two of the cores that this process may use; where it has one only, that one twice."""
    cores = os.sched_getaffinity(0)
    return min(cores), max(cores)


@contextmanager
def pinned_to(core: int | None) -> Iterator[None]:
    """Let processes that are started in the context run on one core only; None: on any."""
    if core is None:
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {core})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def _memory_mb(pid: int) -> dict[str, float]:
    lines = (_PROC / str(pid) / "smaps_rollup").read_text().splitlines()[1:]
    return {name: int(size) * 1024 / 1e6 for name, size, *_ in map(str.split, lines)}


def _stat(pid: int) -> list[str]:
    """Return the fields after the name, which may hold spaces: state, parent, ..."""
    return (_PROC / str(pid) / "stat").read_text().rpartition(")")[2].split()
