"""Raw data of a profile: one line of CSV for each run, with the times that were seen."""

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TextIO

OK, FAILED = "ok", "failed"

TIMES = (
    "counts_from_s",
    "first_bad_s",
    "error_s",
    "pause_s",
    "zero_s",
    "first_good_s",
    "running_s",
    "resume_s",
    "drive_s",
    "echo_1_s",
    "echo_2_s",
)
"""Columns of times, empty where nothing was seen. The echoes are durations; all others are on one
clock, whose zero has no meaning."""

_COLUMNS = ("run", "trigger", "status", "reason", "started_at", "persistence_s", *TIMES)


class InvalidRunFileError(Exception):
    """A file that does not hold runs; the message says where."""


@dataclass(frozen=True, slots=True)
class Run:
    """One stop and one start of the robot."""

    number: int
    trigger: str
    """The error that stopped the robot."""
    started_at: str
    """Wall time in UTC (RFC 3339)."""
    persistence_s: float
    times: Mapping[str, float] = field(default_factory=dict)
    """In s, by the names of `TIMES`."""
    reason: str = ""
    """Why the run failed; empty: it succeeded."""

    @property
    def is_ok(self) -> bool:
        """Tell whether everything was seen, and nothing else."""
        return not self.reason


class RunWriter:
    """Writes each run as soon as it has ended, so that what was measured is kept."""

    def __init__(self, file: TextIO) -> None:
        """Write the names of the columns.

        Args:
            file: Open for writing, with `newline=""`.
        """
        self._file = file
        self._csv = csv.writer(file, lineterminator="\n")
        self._csv.writerow(_COLUMNS)
        file.flush()

    def write(self, run: Run) -> None:
        """Write one run."""
        status = OK if run.is_ok else FAILED
        times = (f"{run.times[name]:.6f}" if name in run.times else "" for name in TIMES)
        head = (run.number, run.trigger, status, run.reason, run.started_at, run.persistence_s)
        self._csv.writerow((*head, *times))
        self._file.flush()


def read_runs(path: Path) -> Iterator[Run]:
    """Yield the runs of a file.

    Raises:
        OSError: The file cannot be read.
        InvalidRunFileError: It holds something else.
    """
    with path.open(encoding="utf-8", newline="") as file:
        rows = csv.DictReader(file)
        try:
            missing = [name for name in _COLUMNS if name not in (rows.fieldnames or ())]
            if missing:
                raise InvalidRunFileError(f"{path}:1: no column {missing[0]}; is it of a profile?")
            for row in rows:
                yield _run(row)
        except (ValueError, TypeError, csv.Error) as error:
            raise InvalidRunFileError(f"{path}:{rows.line_num}: {error}") from error


def _run(row: Mapping[str, str]) -> Run:
    """Return the run of a line.

    Raises:
        ValueError: A cell is not a number, or the status and the reason contradict each other.
        TypeError: A cell is missing.
    """
    reason = row["reason"]
    if row["status"] != (FAILED if reason else OK):
        raise ValueError(f"status {row['status']!r} does not fit the reason {reason!r}")
    return Run(
        number=int(row["run"]),
        trigger=row["trigger"],
        started_at=row["started_at"],
        persistence_s=float(row["persistence_s"]),
        times={name: float(row[name]) for name in TIMES if row[name] != ""},
        reason=reason,
    )
