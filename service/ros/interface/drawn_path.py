"""The path of a task as a line of not too many points."""

from math import cos, sin

from domain.arrays import Floats, Integers, np
from domain.paths.decimation import Decimation
from domain.paths.path import Path
from domain.snapshot import TaskView
from service.ros.interface.endpoints import Fields

TOLERANCE_M = 0.05
"""A waypoint is left out if it is no farther than this from the drawn line."""
MOST_POINTS = 1_000
"""A path that needs more is drawn less exactly."""

_OVER_GROUND_M = 0.05


class DrawnPath:
    """The points of a path that are needed to draw it, found bit by bit."""

    def __init__(self, task: TaskView, path: Path) -> None:
        """Prepare; the waypoints before the start of the task are not drawn."""
        self.task = task.id
        self._path = path
        self._begun_m = path.distance_of(task.start_index)
        self._first = task.start_index
        places = path.waypoints[self._first :, :2]
        self._decimation = Decimation(places, TOLERANCE_M, MOST_POINTS)
        self._points: list[Fields] = []
        self._headings: list[float] = []
        self._distances: Floats = np.empty(0)

    @property
    def is_done(self) -> bool:
        """Tell whether the points are found."""
        return bool(self._points)

    def go_on(self) -> None:
        """Look for the points of the next stretch; some 2 ms."""
        self._decimation.go_on()
        if self._decimation.is_done:
            self._take(self._decimation.indices + self._first)

    def _take(self, kept: Integers) -> None:
        places = self._path.waypoints[kept, :2]
        ways = np.diff(places, axis=0)
        headings = np.arctan2(ways[:, 1], ways[:, 0]).tolist()
        self._headings = [*headings, headings[-1]]
        self._distances = np.array([self._path.distance_of(index) for index in kept.tolist()])
        self._points = [{"x": x, "y": y, "z": _OVER_GROUND_M} for x, y in places.tolist()]

    def lines(self, task: TaskView) -> tuple[list[Fields], list[Fields]]:
        """Return the points of what is done of the path, and of what is ahead.

        Both are `geometry_msgs/msg/Point`, and empty where there is nothing to draw.
        """
        reached_m = self._begun_m + task.distance_m
        passed = int(self._distances.searchsorted(reached_m, side="right"))
        place = self._path.point_at(reached_m)
        here = {"x": place.x_m, "y": place.y_m, "z": _OVER_GROUND_M}
        done, ahead = self._points[:passed], self._points[passed:]
        return [*done, here] if done else [], [here, *ahead] if ahead else []

    def poses(self, header: Fields) -> list[Fields]:
        """Return the points as `geometry_msgs/msg/PoseStamped`, each facing the next one."""
        return [
            {
                "header": header,
                "pose": {
                    "position": place,
                    "orientation": {"x": 0.0, "y": 0.0, "z": sin(yaw / 2), "w": cos(yaw / 2)},
                },
            }
            for place, yaw in zip(self._points, self._headings, strict=True)
        ]
