"""The start task of a robot file: submitted at the start, driven once there are no holds.

After an earlier run of the service nothing moves before an operator asks for it: the start task
waits for its own hold, and is left out while an earlier task has not ended.
"""

import logging
from pathlib import Path as FilePath

from domain.actor import Actor
from domain.errors import PilothouseError
from domain.inputs import HoldRequest, TaskRequest
from domain.paths.headings import Heading
from domain.paths.path import Path
from service.files.csv_columns import column_names
from service.files.driving_block import StartTaskBlock
from service.files.text_file import decode_csv, read_bytes
from service.files.waypoint_file import read_waypoints_csv
from service.supervisor import Supervisor

HOLD = "start_task"
"""Keeps the start task from running by itself after a restart."""

_WAITS = "the service was restarted: release this hold to drive the start task"
_ACTOR = Actor("robot file")

log = logging.getLogger(__name__)


class StartTaskError(PilothouseError):
    """A start task that cannot be driven."""

    code = "INVALID_START_TASK"


def submit_start_task(supervisor: Supervisor, task: StartTaskBlock, robot_file: FilePath) -> None:
    """Submit the start task.

    Args:
        supervisor: Of the robot that drives it.
        task: The block `start_task` of the robot file.
        robot_file: Relative paths are resolved against its folder.

    Raises:
        UnreadableFileError: The waypoint file does not exist, or is too large.
        StartTaskError: The waypoints are invalid, or this vehicle cannot drive their path.
    """
    if supervisor.core.driving.current_task is not None:
        log.warning("the start task is left out: an earlier task has not ended")
        return
    file = robot_file.parent / task.file
    text = decode_csv(read_bytes(file))
    heading = None if task.heading is None else Heading(task.heading)
    columns = None if task.columns is None else column_names(task.columns)
    try:
        path = Path(read_waypoints_csv(text, heading, columns))
        asked = TaskRequest(path, 0, task.controller, task.speed_mps, _ACTOR)
        if supervisor.journal is not None and not supervisor.journal.found.is_new:
            supervisor.submit(HoldRequest(HOLD, _WAITS, _ACTOR))
        supervisor.submit(asked)
    except PilothouseError as error:
        raise StartTaskError(f"start_task {file}: {error.message}") from error
