"""Paths to drive along."""

import numpy as np

from domain.paths.path import Path


def straight(length_m: float = 20.0, spacing_m: float = 1.0, y_m: float = 0.0) -> Path:
    """Return a path along the x axis."""
    x = np.arange(0.0, length_m + spacing_m / 2, spacing_m)
    return Path(np.column_stack((x, np.full_like(x, y_m), np.zeros_like(x))))
