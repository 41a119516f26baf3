"""What benches let a service work on while it drives: long paths, and an hour in virtual time."""

import io
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from domain.paths.path import Path
from service.example_tracks import track_text
from tests.support.good import GOOD

POINTS = 100_000
"""As many as a path may have."""
HOUR_S = 3_600


def example_loop() -> Path:
    """Return the loop that comes with the program, 800 m."""
    return Path(np.loadtxt(io.StringIO(track_text("loop")), delimiter=","))


def dense(path: Path) -> NDArray[np.float64]:
    """Return a path with 100,000 waypoints, shape (100,000, 3): x m, y m, yaw rad."""
    along = np.linspace(0, path.length_m, POINTS).tolist()
    places = [path.point_at(distance) for distance in along]
    yaws = [path.heading_at(distance) for distance in along]
    return np.array([(place.x_m, place.y_m, yaw) for place, yaw in zip(places, yaws, strict=True)])


def as_posted(waypoints: NDArray[np.float64], start_index: int = 0) -> dict[str, Any]:
    """Return waypoints, shape (n, 3), as the body of a task."""
    items = [{"x_m": x, "y_m": y, "yaw_rad": yaw} for x, y, yaw in waypoints.tolist()]
    return {"waypoints": items, "start_index": start_index}


def hour() -> bytes:
    """Return a scenario: an hour, at whose begin the example loop is driven in 5 minutes."""
    task = as_posted(example_loop().waypoints)
    steps = [{"t_s": 0, "reading": dict(GOOD)}, {"t_s": 0.5, "task": task}]
    robot = {"signals": {"stale_after_s": 0}}
    body = {"robot": robot, "until_s": HOUR_S, "sample_period_s": 1, "steps": steps}
    return json.dumps(body).encode()
