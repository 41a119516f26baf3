"""How requests about tasks and holds are recorded as events."""

from collections.abc import Mapping

from domain.inputs import (
    CancelTaskRequest,
    DriveRequest,
    HoldRequest,
    ReleaseRequest,
    TaskRequest,
)


def describe_drive_request(request: DriveRequest) -> tuple[str, Mapping[str, object]]:
    """Return kind and data of the event that records a request."""
    match request:
        case TaskRequest():
            return "task.requested", {
                "waypoints": request.path.count,
                "length_m": request.path.length_m,
                "start_index": request.start_index,
                "controller": request.controller,
                "speed_mps": request.speed_mps,
            }
        case CancelTaskRequest():
            return "task.cancel_requested", {}
        case HoldRequest():
            return "hold.requested", {"owner": request.owner, "reason": request.reason}
        case ReleaseRequest():
            return "hold.release_requested", {"owner": request.owner}
