"""The task that a robot file names: submitted at the start, driven once nothing holds it."""

from pathlib import Path as FilePath

from domain.actor import Actor
from domain.errors import PilothouseError
from domain.inputs import TaskRequest
from domain.paths.path import Path
from service.files.driving_block import StartTaskBlock
from service.files.text_file import read_text_file
from service.files.waypoint_file import read_waypoints_csv
from service.supervisor import Supervisor


class StartTaskError(PilothouseError):
    """A task to begin with that cannot be driven."""

    code = "INVALID_START_TASK"


def submit_start_task(supervisor: Supervisor, task: StartTaskBlock, robot_file: FilePath) -> None:
    """Submit the task to begin with.

    Args:
        supervisor: Of the robot that drives it.
        task: What the robot file says.
        robot_file: From where a relative path counts.

    Raises:
        UnreadableFileError: There is no such file, or it is not a text.
        StartTaskError: It is no path, or one that this vehicle cannot drive.
    """
    file = robot_file.parent / task.file
    text = read_text_file(file)
    try:
        path = Path(read_waypoints_csv(text))
        asked = TaskRequest(path, 0, task.controller, task.speed_mps, Actor("robot file"))
        supervisor.submit(asked)
    except PilothouseError as error:
        raise StartTaskError(f"start_task {file}: {error.message}") from error
