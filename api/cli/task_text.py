"""Progress and status of a task as text."""

from api.client.outcomes import Json

_BAR_WIDTH = 15


def progress_text(task: Json, speed_mps: float | None) -> str:
    """Return the progress of a task, and its speed or why it waits; fits 80 columns.

    Args:
        task: The task, as in `GET /tasks/{id}`.
        speed_mps: Speed of the vehicle in m/s; None: unknown.
    """
    share = task["progress"]
    bar = ("#" * round(share * _BAR_WIDTH)).ljust(_BAR_WIDTH, ".")
    begin = f"[{bar}] {share:4.0%} {distance_text(task)}"
    if task["reason"]:
        return f"{begin}  {status_text(task)}"
    speed = "? m/s" if speed_mps is None else f"{speed_mps:.1f} m/s"
    error_m = task["cross_track_error_m"]
    error = "" if error_m is None else f"  {error_m:+.2f} m off"
    return f"{begin}  {speed}{error}  {status_text(task)}"


def distance_text(task: Json) -> str:
    """Return the distance traveled and the length of the path."""
    return f"{task['distance_m']:.1f} of {task['length_m']:.1f} m"


def status_text(task: Json) -> str:
    """Return the status of a task, with its reason if there is one."""
    words, reason = str(task["status"]).lower(), task["reason"]
    return f"{words}: {reason}" if reason and reason != words else words
