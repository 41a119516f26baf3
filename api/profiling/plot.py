"""Draws the distributions of latencies; the only module that needs matplotlib."""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from api.profiling.analysis import LATENCIES, Latency, echoes_ms, latency_ms
from api.profiling.run_file import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_STOP = next(latency for latency in LATENCIES if latency.key == "bad_to_zero")
_START = next(latency for latency in LATENCIES if latency.key == "good_to_drive")


class NoMatplotlibError(Exception):
    """matplotlib is not installed; the message says how to get it."""


def check_plot() -> None:
    """Check that matplotlib is there, before anything is measured; it is not loaded yet.

    Raises:
        NoMatplotlibError: It is not installed.
    """
    if find_spec("matplotlib") is None:
        raise NoMatplotlibError(
            "the plot needs matplotlib: install pilothouse[plot], or leave out --plot"
        )


def draw(runs: Sequence[Run], file: Path) -> None:
    """Draw how many of the stops and starts were seen within which time.

    Args:
        runs: What was measured.
        file: Where to store the picture; its kind follows from the name.

    Raises:
        NoMatplotlibError: matplotlib is not installed.
        OSError: The file cannot be written.
    """
    check_plot()
    import matplotlib as mpl
    from matplotlib import pyplot

    # Without a display, and without opening a window.
    mpl.use("Agg")
    figure, axes = pyplot.subplots(
        1, 2, figsize=(10, 4.5), sharex=True, sharey=True, layout="constrained"
    )
    for side, latency in zip(axes, (_STOP, _START), strict=True):
        _draw(side, runs, latency)
    axes[0].set_ylabel("share of the runs, %")
    figure.legend(*axes[1].get_legend_handles_labels(), loc="outside right center")
    figure.savefig(file, dpi=100)
    pyplot.close(figure)


def _draw(axes: "Axes", runs: Sequence[Run], latency: Latency) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    for trigger in dict.fromkeys(run.trigger for run in runs):
        own = [latency_ms(run, latency) for run in runs if run.trigger == trigger]
        _draw_shares(axes, own, trigger, "-")
    echoes = [echo for run in runs for echo in echoes_ms(run)]
    _draw_shares(axes, echoes, "echo", ":")
    axes.set(title=f"From {latency.words}", xlabel="ms", xscale="log", ylim=(0, 101))
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.grid(visible=True, which="both", alpha=0.3)


def _draw_shares(axes: "Axes", values: Sequence[float | None], label: str, style: str) -> None:
    """Draw a distribution; failed runs keep it below 100 %."""
    seen = np.sort([value for value in values if value is not None])
    if seen.size:
        shares = 100 * np.arange(1, seen.size + 1) / len(values)
        colour = "black" if style == ":" else None
        axes.step(seen, shares, style, where="post", label=label, color=colour)
