"""Writes the tracks in this folder: `python examples/tracks/make_tracks.py`.

Each is a CSV as recorded with smart_polaris, `x,y,yaw` in m, m and rad. It starts at the origin
heading along x, like the example vehicle. The loop is also the built-in example track.
"""

from collections.abc import Iterator, Mapping
from itertools import pairwise
from math import pi, radians
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).resolve().parent
BUILT_IN = HERE.parents[1] / "service" / "example" / "loop.csv"

_FINE_M = 0.01
"""Integration step; over 800 m, its error is below the last digit written."""

Bend = tuple[float, float]
"""A segment: its length, m, and the curvature at its end, 1/m."""


def straight(length_m: float) -> list[Bend]:
    """Return a straight."""
    return [(length_m, 0.0)]


def turn(angle_deg: float, radius_m: float, easing_m: float) -> list[Bend]:
    """Return a curve between straights; its curvature rises and falls linearly, as on a road.

    Args:
        angle_deg: Change of heading, left positive.
        radius_m: In the middle of the curve; > 0.
        easing_m: Length of either transition; < `radius_m` times the angle in rad.
    """
    curvature = np.copysign(1 / radius_m, angle_deg)
    arc_m = radius_m * abs(radians(angle_deg)) - easing_m
    return [(easing_m, curvature), (arc_m, curvature), (easing_m, 0.0)]


def track(
    bends: list[Bend], spacing_m: float, length_m: float | None = None
) -> NDArray[np.float64]:
    """Return waypoints along bends, from the origin along x.

    Args:
        bends: One after the other; the first begins straight.
        spacing_m: Between waypoints.
        length_m: Length of the track, less than that of all bends; None: ends after the last bend.

    Returns:
        Shape (n, 3): x m, y m, yaw rad from -pi to pi.
    """
    ends = np.concatenate(([0.0], np.cumsum([length for length, _ in bends])))
    curvatures = [0.0, *(curvature for _, curvature in bends)]
    along = np.arange(0.0, ends[-1] + _FINE_M, _FINE_M)
    yaw = _integral(np.interp(along, ends, curvatures))
    at = np.arange(0.0, (ends[-1] if length_m is None else length_m) + 1e-9, spacing_m)
    x, y = (np.interp(at, along, _integral(part)) for part in (np.cos(yaw), np.sin(yaw)))
    yaws = np.interp(at, along, yaw)
    return np.column_stack((x, y, (yaws + pi) % (2 * pi) - pi))


def corner(*places: tuple[float, float], spacing_m: float) -> NDArray[np.float64]:
    """Return waypoints along straights between points, with sharp corners; shape (n, 3)."""
    pieces = []
    for begin, end in pairwise(np.array(places)):
        length = float(np.hypot(*(end - begin)))
        way = (end - begin) / length
        at = np.arange(0.0, length - 1e-9, spacing_m)[:, np.newaxis]
        pieces.append(np.hstack((begin + at * way, np.full(at.shape, np.arctan2(way[1], way[0])))))
    last = np.array([[*places[-1], pieces[-1][-1, 2]]])
    return np.vstack((*pieces, last))


def loop() -> NDArray[np.float64]:
    """Return a lap of 800 m with radii of at least 40 m that ends just before its start.

    One half turns by 180 degrees; driving the same half twice leads back to the start.
    """
    curves = (turn(110, 40, 20), turn(-40, 60, 20), turn(110, 45, 20))
    rest_m = 400 - sum(length for curve in curves for length, _ in curve)
    first, second, third = curves
    half = [
        *straight(0.35 * rest_m),
        *first,
        *straight(0.15 * rest_m),
        *second,
        *straight(0.15 * rest_m),
        *third,
        *straight(0.35 * rest_m),
    ]
    return track(2 * half, 0.5, 799.5)


def overlap() -> NDArray[np.float64]:
    """Return a small lap that overlaps its own start by 3 m."""
    half = [*straight(15), *turn(180, 12, 8), *straight(15)]
    lap_m = 2 * sum(length for length, _ in half)
    return track([*half, *half, *straight(3)], 0.5, lap_m + 3)


def out_and_back() -> NDArray[np.float64]:
    """Return a path out, a drop-shaped turn, and the path back next to the path out."""
    drop = [*turn(-60, 6, 2.5), *turn(300, 6, 2.5), *turn(-60, 6, 2.5)]
    return track([*straight(40), *drop, *straight(40)], 0.25)


def _csv(waypoints: NDArray[np.float64]) -> str:
    # Adding 0 turns -0.000 into 0.000.
    places, yaws = np.round(waypoints[:, :2], 3) + 0.0, np.round(waypoints[:, 2], 4) + 0.0
    rows = zip(*places.T.tolist(), yaws.tolist(), strict=True)
    return "".join(f"{x:.3f},{y:.3f},{yaw:.4f}\n" for x, y, yaw in rows)


def _integral(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the integral along the track; shape (n,) as `values`, `_FINE_M` apart."""
    steps = (values[:-1] + values[1:]) * (_FINE_M / 2)
    return np.concatenate(([0.0], np.cumsum(steps)))


TRACKS: Mapping[str, NDArray[np.float64]] = {
    "loop": loop(),
    "overlap": overlap(),
    "short_5m": corner((0, 0), (5, 0), spacing_m=0.5),
    "right_angle": corner((0, 0), (20, 0), (20, 20), spacing_m=0.5),
    "out_and_back": out_and_back(),
}
"""Waypoints by name; shape (n, 3) each: x m, y m, yaw rad."""


def files() -> Iterator[tuple[Path, str]]:
    """Yield each file with its text."""
    for name, waypoints in TRACKS.items():
        yield HERE / f"{name}.csv", _csv(waypoints)
    yield BUILT_IN, _csv(TRACKS["loop"])


if __name__ == "__main__":
    for path, text in files():
        path.write_text(text, encoding="utf-8", newline="\n")
