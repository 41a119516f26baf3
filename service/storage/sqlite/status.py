"""How storage is doing, made of what the writer's thread reported last."""

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from service.clock import to_datetime
from service.storage.journal import LogStatus, StorageStatus
from service.storage.sqlite.connection import library_version
from service.storage.sqlite.folder import Report
from service.storage.sqlite.log_summary import LogSummary


def status_of(
    folder: Path, boot: int, report: Report, reason: str | None, lost: tuple[int, int]
) -> StorageStatus:
    """Return how storage is doing.

    Args:
        folder: Where it is.
        boot: Number of this run.
        report: The last one of the writer's thread.
        reason: Why storage is degraded, if it is.
        lost: Inputs and events that this run could not write down.
    """
    lost_inputs, lost_events = lost
    return StorageStatus(
        str(folder),
        report.bytes,
        report.free_bytes,
        reason,
        library_version(),
        boot,
        {"inputs": _inputs(report.files), "events": _events(report.files)},
        lost_inputs,
        lost_events,
    )


def _inputs(files: Sequence[LogSummary]) -> LogStatus:
    return LogStatus(
        _moment(min((file.first_wall_ns for file in files if file.first_wall_ns), default=0)),
        _moment(max((file.wall_ns for file in files), default=0)),
        sum(file.step_bytes for file in files),
    )


def _events(files: Sequence[LogSummary]) -> LogStatus:
    filled = [file for file in files if file.last_event]
    return LogStatus(
        _moment(min((file.first_event_wall_ns for file in filled), default=0)),
        _moment(max((file.last_event_wall_ns for file in filled), default=0)),
        sum(file.event_bytes for file in files),
    )


def _moment(wall_ns: int) -> datetime | None:
    return to_datetime(wall_ns) if wall_ns else None
