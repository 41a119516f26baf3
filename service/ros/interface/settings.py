"""What a robot file says about the interface."""

from dataclasses import dataclass

from domain.vehicle import DEFAULT_FRAME
from service.files.waypoint_folder import WaypointFolder
from service.ros.interface.message_sets import MessageSet


@dataclass(frozen=True, slots=True)
class InterfaceSettings:
    """Settings of the interface, the same in a ROS graph and over rosbridge."""

    messages: MessageSet = MessageSet.PILOTHOUSE
    """The package that signals and the state of the robot are named in."""
    folder: WaypointFolder | None = None
    """Where files of tasks are looked up by their name; None: nowhere."""
    frame_id: str = DEFAULT_FRAME
    """Coordinate frame of poses and waypoints."""


USUAL_SETTINGS = InterfaceSettings()
