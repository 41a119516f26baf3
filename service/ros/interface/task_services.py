"""The services that begin a task: with a waypoint file, or with the waypoints themselves."""

import asyncio
import logging
from collections.abc import Mapping
from typing import Any

from domain.actor import Actor
from domain.errors import InvalidValueError, PilothouseError, RefusedError
from domain.inputs import TaskRequest
from domain.paths.path import Path
from service.files.csv_table import InvalidWaypointsError
from service.files.driving_block import DEFAULT_CONTROLLER, DEFAULT_SPEED_MPS
from service.files.waypoint_folder import WaypointFolder, check_name
from service.numpy_loading import numpy_loaded
from service.ros.interface.endpoints import OWN_NODE, Fields, OfferedService
from service.ros.interface.message_check import DRIVE_WAYPOINTS, START_TASK, checked
from service.ros.interface.waypoint_jobs import check_count, read_track, rows_of
from service.supervisor import Supervisor
from service.worker import Jobs

log = logging.getLogger(__name__)

SERVE_WAYPOINTS_NAME = "/serve_waypoints"
DRIVE_WAYPOINTS_NAME = "/drive_waypoints"

_HERE = 500
"""Up to this many waypoints are checked in less than 5 ms, and are not worth sending elsewhere."""
_MAX_MESSAGE = 1_000
"""Characters of a reason."""


class NoWaypointFolderError(RefusedError):
    """A waypoint file is named, and the robot file names no folder that it could be in."""

    code = "NO_WAYPOINT_FOLDER"

    def __init__(self) -> None:
        super().__init__("this robot has no folder for waypoint files")
        self.hint = "name one in the robot file: tasks: {folder: tracks}"


class TaskServices:
    """Services that replace the task, in the types of our own package.

    A response tells why a task was rejected, and otherwise the id of the task: it has begun, or
    waits until there are no holds.
    """

    def __init__(self, supervisor: Supervisor, folder: WaypointFolder | None, jobs: Jobs) -> None:
        """Prepare.

        Args:
            supervisor: Of the robot.
            folder: Where named files are looked up; None: nowhere.
            jobs: Do what would keep the event loop.
        """
        self._supervisor = supervisor
        self._folder = folder
        self._jobs = jobs

    def offered(self) -> tuple[OfferedService, ...]:
        """Return the services."""
        calls = {
            SERVE_WAYPOINTS_NAME: ("StartTask", self.serve_waypoints),
            DRIVE_WAYPOINTS_NAME: ("DriveWaypoints", self.drive_waypoints),
        }
        return tuple(
            OfferedService(
                name=name,
                type=f"pilothouse_msgs/srv/{type_name}",
                node=OWN_NODE,
                of_a_node=False,
                call=call,
                writes=True,
            )
            for name, (type_name, call) in calls.items()
        )

    async def serve_waypoints(self, request: Fields, caller: Actor) -> Fields:
        """Drive a waypoint file of the folder."""
        asked = checked(START_TASK, request)
        name = asked["file"]
        try:
            if self._folder is None:
                raise NoWaypointFolderError
            check_name(name)
            await numpy_loaded()
            track = await self._jobs.call(read_track, self._folder, name)
            response = await self._begin(track.path, asked, caller)
        except PilothouseError as error:
            return _rejected(f"{name!r:.100}", caller, error)
        for warning in track.warnings:
            log.warning("%s of %s: %s", response["task"], name, warning)
        return response

    async def drive_waypoints(self, request: Fields, caller: Actor) -> Fields:
        """Drive the waypoints of the request."""
        asked = checked(DRIVE_WAYPOINTS, request)
        waypoints = asked["waypoints"]
        try:
            check_count(waypoints)
            await numpy_loaded()
            if len(waypoints) <= _HERE:
                path = Path(rows_of(waypoints))
            else:
                # A thread for many small objects, which would be packed for the worker here.
                rows = await asyncio.to_thread(rows_of, waypoints)
                path = await self._jobs.call(Path, rows)
            return await self._begin(path, asked, caller)
        except PilothouseError as error:
            return _rejected(f"{len(waypoints)} waypoints", caller, error)

    async def _begin(self, path: Path, asked: Mapping[str, Any], caller: Actor) -> Fields:
        """Submit a task.

        Raises:
            PilothouseError: It is rejected.
        """
        request = TaskRequest(
            path,
            asked["start_index"],
            asked["controller"] or DEFAULT_CONTROLLER,
            asked["speed_mps"] or DEFAULT_SPEED_MPS,
            caller,
        )
        task = (await self._supervisor.request(request)).outputs.task
        if task is None:
            raise RuntimeError("a task was taken and has no id")
        return {"success": True, "message": "", "task": task}


def _rejected(what: str, caller: Actor, error: PilothouseError) -> Fields:
    message = _reason(error)
    log.info("rejected a task of %s, requested by %s: %s", what, caller.label, message)
    return {"success": False, "message": message, "task": ""}


def _reason(error: PilothouseError) -> str:
    """Return why a task is rejected, with a hint that helps a caller of a service."""
    hint = error.hint
    if isinstance(error, InvalidWaypointsError):
        # Its own hint is about options of requests over HTTP.
        hint = "name the columns in the first line of the file, such as x,y,yaw"
    place = ""
    if isinstance(error, InvalidValueError) and error.pointer.startswith("/waypoints/"):
        place = f"{error.pointer[1:]}: "
    told = "" if hint is None else f" ({hint})"
    return f"{place}{error.message}{told}"[:_MAX_MESSAGE]
