"""From the times of runs to latencies, and from these to figures."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from api.profiling.run_file import Run

PERCENTILES = (50, 95, 99)


@dataclass(frozen=True, slots=True)
class Latency:
    """A latency: from a reading, or from the end of the persistence, to what a client sees."""

    key: str
    words: str
    seen: str
    """Time at which it ends; an echo is a duration."""
    is_stop: bool = False
    """It begins when the error is due, and not with the first good reading."""


LATENCIES = (
    Latency("bad_to_error", "bad reading to ERROR", "error_s", is_stop=True),
    Latency("bad_to_pause", "bad reading to task paused", "pause_s", is_stop=True),
    Latency("bad_to_zero", "bad reading to zero command", "zero_s", is_stop=True),
    Latency("good_to_running", "good reading to RUNNING", "running_s"),
    Latency("good_to_resume", "good reading to task resumed", "resume_s"),
    Latency("good_to_drive", "good reading to drive command", "drive_s"),
)
ECHO = Latency("echo", "echo", "")
_ECHOES = ("echo_1_s", "echo_2_s")


@dataclass(frozen=True, slots=True)
class Summary:
    """The figures of one latency of one trigger."""

    trigger: str
    latency: Latency
    count: int
    """How many there should be."""
    failed: int
    """How many of them are missing, or came before they were due."""
    figures: Mapping[str, float]
    """In ms: `min`, `mean`, `p50`, `p95`, `p99`, `max` and `std`; empty if nothing was seen."""

    def as_json(self) -> dict[str, Any]:
        """Return it with units in the names."""
        named = {f"{name}_ms": round(value, 4) for name, value in self.figures.items()}
        share = {"success_percent": round(100 * (1 - self.failed / self.count), 2)}
        head = {"trigger": self.trigger, "latency": self.latency.key}
        return head | {"count": self.count, "failed": self.failed} | share | named


def latency_ms(run: Run, latency: Latency) -> float | None:
    """Return a latency of a run in ms, without the persistence; None: it failed."""
    times = run.times
    begin = times.get("counts_from_s" if latency.is_stop else "first_good_s")
    seen = times.get(latency.seen)
    if begin is None or seen is None:
        return None
    if latency.is_stop:
        begin += run.persistence_s
    return 1000 * (seen - begin) if seen >= begin else None


def echoes_ms(run: Run) -> list[float | None]:
    """Return the echoes of a run in ms; None: it failed before."""
    return [1000 * run.times[name] if name in run.times else None for name in _ECHOES]


def summaries(runs: Sequence[Run]) -> Iterator[Summary]:
    """Yield the figures of each trigger: its latencies, then the echoes beside them.

    A run that failed counts: as failed where a time is missing, and with its time where not.
    """
    for trigger in dict.fromkeys(run.trigger for run in runs):
        own = [run for run in runs if run.trigger == trigger]
        for latency in LATENCIES:
            yield _summary(trigger, latency, [latency_ms(run, latency) for run in own])
        yield _summary(trigger, ECHO, [echo for run in own for echo in echoes_ms(run)])


def figures_of(values_ms: Iterable[float]) -> Mapping[str, float]:
    """Return extremes, mean, percentiles (linear interpolation) and standard deviation in ms."""
    values = np.array(list(values_ms))
    if not values.size:
        return MappingProxyType({})
    found = {"min": values.min(), "mean": values.mean()}
    found |= {f"p{share}": np.percentile(values, share) for share in PERCENTILES}
    found |= {"max": values.max(), "std": values.std()}
    return MappingProxyType({name: float(value) for name, value in found.items()})


def _summary(trigger: str, latency: Latency, values: Sequence[float | None]) -> Summary:
    seen = [value for value in values if value is not None]
    return Summary(trigger, latency, len(values), len(values) - len(seen), figures_of(seen))
