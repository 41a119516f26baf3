"""A window as an operator would describe it, and readings for it."""

from collections.abc import Iterable

from domain.timebase import Instant, seconds
from domain.windows.settings import LEAST_R2, Statistic, Threshold, WindowSettings
from domain.windows.window import Window

START: Instant = seconds(1000.0)


def window(
    statistic: Statistic,
    window_s: float | None = None,
    window_n: int | None = None,
    *,
    min_n: int = 2,
    q: float | None = None,
    limit: Threshold | None = None,
    min_r2: float = LEAST_R2,
) -> Window:
    """Return a window that listens since `START`."""
    settings = WindowSettings(
        statistic=statistic,
        length=None if window_s is None else seconds(window_s),
        size=window_n,
        min_n=min_n,
        q=q,
        limit=limit,
        min_r2=min_r2,
    )
    return Window(settings, START)


def fill(filled: Window, readings: Iterable[tuple[float, float]]) -> Window:
    """Let readings arrive, each given as seconds since `START` and a value; return the window."""
    for after_s, value in readings:
        filled.add(after(after_s), value)
    return filled


def after(elapsed_s: float) -> Instant:
    """Return the instant so many seconds after `START`."""
    return START + seconds(elapsed_s)


def above(limit: float) -> Threshold:
    """Return the side above a limit."""
    return Threshold(limit, above=True)


def below(limit: float) -> Threshold:
    """Return the side below a limit."""
    return Threshold(limit, above=False)
