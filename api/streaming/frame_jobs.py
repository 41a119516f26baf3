"""Jobs on what was recorded: the frame of one moment, replayed from the last checkpoint before it.

Arguments and results can be pickled, since the worker runs these functions.
"""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from api.distribution import installed_version
from api.streaming.client_input import STATE_TOPICS
from api.streaming.encoder import StreamEncoder
from domain.errors import StorageDegradedError
from domain.timebase import Duration
from service.recorded_pieces import MomentNotRecordedError, piece_at
from service.replayed_robot import ReplayedRobot
from service.storage.errors import UnusableFolderError
from service.storage.sqlite.connection import FAILURES, words
from service.storage.sqlite.recorded_log import RecordedLog

_MILLISECOND: Duration = 1_000_000


@dataclass(frozen=True, slots=True)
class WantedFrame:
    """A moment of a recorded robot."""

    folder: str
    """Its folder of data."""
    moment: datetime
    now: datetime | None
    """How far the run has come that goes on; None: as far as is on disk."""
    simulated: tuple[str, ...]
    """The simulated pieces of the robot."""


def frame_of(wanted: WantedFrame) -> bytes:
    """Return the complete `state` frame of a moment, as the stream would have sent it.

    It shows everything up to the end of that millisecond: an event and its consequences are shown
    with the same one.

    Raises:
        MomentNotRecordedError: The record does not have it.
        StorageDegradedError: The record cannot be read.
        PilothouseError: It cannot be replayed.
    """
    moment = wanted.moment.replace(microsecond=wanted.moment.microsecond // 1000 * 1000)
    try:
        log = RecordedLog(Path(wanted.folder))
        piece, at = piece_at(log, installed_version(), moment, wanted.now)
        robot = ReplayedRobot(piece, installed_version(), wanted.simulated)
        robot.advance_to(at + _MILLISECOND - 1)
    except UnusableFolderError as error:
        raise StorageDegradedError.while_reading("the record", str(error)) from error
    except FAILURES as error:
        raise StorageDegradedError.while_reading("the record", words(error)) from error
    robot.publish()
    frame = robot.supervisor.frames.complete()
    if frame is None:
        raise MomentNotRecordedError("nothing was published then", ())
    return StreamEncoder(robot.supervisor).frame(frame, 0, STATE_TOPICS)
