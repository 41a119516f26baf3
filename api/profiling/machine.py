"""What machine figures were measured on."""

import os
import platform
from pathlib import Path

_CPU_INFO = Path("/proc/cpuinfo")


def machine_facts() -> dict[str, str]:
    """Return what a figure depends on: processor, cores, kernel and Python."""
    return {
        "CPU": _processor(),
        "cores": str(os.cpu_count()),
        "system": f"{platform.system()} {platform.release()}",
        "Python": f"{platform.python_implementation()} {platform.python_version()}",
    }


def _processor() -> str:
    if _CPU_INFO.exists():
        for line in _CPU_INFO.read_text().splitlines():
            name, _, value = line.partition(":")
            if name.strip() == "model name":
                return value.strip()
    return platform.processor() or platform.machine()


def load_facts() -> dict[str, str]:
    """Return what a latency depends on besides: other work, and the priority over it."""
    facts = {}
    if hasattr(os, "getloadavg"):
        facts["average before"] = f"{os.getloadavg()[0]:.2f}"
    if hasattr(os, "sched_getscheduler"):
        facts["scheduling"] = _scheduling()
    return facts


def _scheduling() -> str:
    real_time = {os.SCHED_FIFO: "SCHED_FIFO", os.SCHED_RR: "SCHED_RR"}
    name = real_time.get(os.sched_getscheduler(0))
    if name is None:
        return f"normal, nice {os.getpriority(os.PRIO_PROCESS, 0)}"
    return f"{name}, priority {os.sched_getparam(0).sched_priority}"
