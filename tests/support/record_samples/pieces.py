"""Pieces that several samples have in common."""

import numpy as np

from domain.identifiers import TaskId
from domain.kept import Kept, KeptHold, KeptProgress
from domain.parameters import Parameters
from domain.paths.path import Path

PARAMETERS: Parameters = {
    "enabled": False,
    "retries": 2**63,
    "gain": 1.0,
    "frame": "base_link",
    "masks": (True, False),
    "ids": (1, -2),
    "limits": (0.1, -0.0),
    "names": ("", "täst"),
    "empty": (),
}
PATH = Path(np.array([[1.5, -0.25, 0.1], [2.5, 1e-7, -3.0], [4.125, 3.0, 0.0]]))
KEPT: tuple[Kept, ...] = (
    KeptHold(owner="operator", reason="pause", by="ada", since=1764420000123456789),
    KeptProgress(task=TaskId("3"), has_run=True, target_index=12, distance_m=51.3, left_out_m=0.75),
)
