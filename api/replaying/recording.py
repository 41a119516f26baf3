"""What can be shown of a record: from when to when, and the pieces from any moment on."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from domain.errors import InvalidValueError
from domain.timebase import Duration, Instant, seconds
from service.clock import to_datetime
from service.exported_record import is_export, read_pieces
from service.files.model_file import read_model
from service.files.robot_file import read_robot_file
from service.recorded_pieces import (
    MomentNotRecordedError,
    NothingRecordedError,
    Piece,
    end_of,
    moment_of,
    offset_of,
    piece_at,
    pieces_of,
)
from service.storage.sqlite.recorded_log import RecordedLog

_BEFORE: Duration = seconds(1.0)
"""A recording that begins with an event begins somewhat earlier."""


@dataclass(frozen=True, slots=True)
class Recording:
    """A record that can be shown; times of day are in ns since 1970 UTC."""

    robot: str
    begin: Instant
    end: Instant
    pieces_from: Callable[[Instant], Iterator[Piece]]
    """Returns the pieces from the one on that a time of day is in."""


def recording_of(
    folder: Path, version: str, first_event: int | None, last_event: int | None
) -> Recording:
    """Return what can be shown of a folder of data, or of what was exported of it.

    Args:
        folder: One or the other.
        version: This release of Pilothouse.
        first_event: Id of the event that it begins with; None: all.
        last_event: Id of the event that it ends with; None: all.

    Raises:
        PilothouseError: There is nothing that can be shown.
        UnusableFolderError: The folder holds no log.
    """
    if is_export(folder):
        if (first_event, last_event) != (None, None):
            raise InvalidValueError("what was exported is replayed as a whole")
        return _of_export(folder)
    log = RecordedLog(folder)
    first = next(pieces_of(log, version, first_event, last_event))
    begin = first.boot.started_at if first.state is None else next(first.steps).at
    begin += offset_of(first.boot)
    if first_event is not None:
        begin = max(begin, moment_of(log, first_event) - _BEFORE)
    end = end_of(log) if last_event is None else moment_of(log, last_event)

    def pieces_from(wall: Instant) -> Iterator[Piece]:
        later = pieces_of(log, version, None, None)
        try:
            piece, _ = piece_at(log, version, to_datetime(wall))
        except MomentNotRecordedError:
            # Between two runs, or lost: the next run is shown.
            return (one for one in later if one.boot.started_at + offset_of(one.boot) >= wall)
        return chain((piece,), (one for one in later if one.first > piece.first))

    return Recording(_name_in(first, folder), begin, end, pieces_from)


def _of_export(folder: Path) -> Recording:
    """Return what was exported: of a bug, and so short enough to be read from its start."""
    times = [
        step.at + offset_of(piece.boot) for piece in read_pieces(folder) for step in piece.steps
    ]
    if not times:
        raise NothingRecordedError("there is no step in it")
    first = next(read_pieces(folder))

    def pieces_from(wall: Instant) -> Iterator[Piece]:
        return read_pieces(folder)

    return Recording(_name_in(first, folder), times[0], times[-1], pieces_from)


def _name_in(piece: Piece, folder: Path) -> str:
    """Return the name of the robot, as its file says it; else that of its folder."""
    model = read_model(piece.boot.model).model
    return read_robot_file(piece.boot.robot, model).name or folder.resolve().name
