"""Draws the picture of docs/tracking.md: `python -m tests.support.track_plot docs/tracking.png`."""

import sys

import matplotlib as mpl
from matplotlib import pyplot
from matplotlib.axes import Axes

from domain.paths.path import Path
from domain.tracking.trackers import TRACKERS
from domain.vehicle import Pose
from tests.support.track_study import PLANTS, drive, errors, track

COLOURS = {"pure_pursuit": "#0b6e99", "stanley": "#c2571a"}
STYLES = {"ideal": "-", "gazebo-like": "--", "car-like": ":"}


def draw(file: str) -> None:
    """Drive the recorded loop and store the picture; its kind follows from the file's name."""
    mpl.use("Agg")
    loop = track("tracks/gem_e2_loop.csv")
    figure, (beside, cruise, fast) = pyplot.subplots(
        3, 1, figsize=(9, 9), layout="constrained", height_ratios=[1.5, 1, 1]
    )
    _draw_way_back(beside, loop)
    _draw_lap(cruise, loop, 2.8)
    _draw_lap(fast, loop, 7.0)
    figure.savefig(file, dpi=110)


def _draw_way_back(axes: Axes, loop: Path) -> None:
    for controller in TRACKERS:
        for plant, settings in PLANTS.items():
            record = drive(loop, controller, settings, Pose(0.0, 0.0, 0.0), time_limit_s=20)
            axes.plot(
                record.driven_m,
                errors(record).cross_track_m,
                STYLES[plant],
                color=COLOURS[controller],
                label=f"{controller}, {plant}",
            )
    axes.axhspan(-0.1, 0.1, color="#dddddd", zorder=0)
    axes.set(
        title="From 2 m beside the path, at 2.8 m/s; grey: within 0.1 m",
        xlabel="driven, m",
        ylabel="error, m",
        xlim=(0, 30),
    )
    axes.legend(ncols=2)


def _draw_lap(axes: Axes, loop: Path, speed_mps: float) -> None:
    for controller in TRACKERS:
        record = drive(loop, controller, PLANTS["ideal"], speed_mps=speed_mps)
        axes.plot(
            record.distance_m,
            1000 * errors(record).cross_track_m,
            color=COLOURS[controller],
            label=controller,
            linewidth=0.9,
        )
    axes.set(
        title=f"Once around at up to {speed_mps:g} m/s, ideal plant",
        xlabel="along the path, m",
        ylabel="error, mm",
        xlim=(0, loop.length_m),
    )
    axes.legend(ncols=2)


if __name__ == "__main__":
    draw(sys.argv[1])
