"""Tracks that come with the program, for a simulated vehicle at the origin."""

from collections.abc import Mapping
from importlib import resources
from types import MappingProxyType

TRACKS: Mapping[str, str] = MappingProxyType({"loop": "A loop of 800 m"})
"""Title by name. Names are never paths: only these are opened."""


def track_text(name: str) -> str:
    """Return one of `TRACKS` as CSV: x, y in m, yaw in rad.

    Raises:
        KeyError: There is none of that name.
    """
    if name not in TRACKS:
        raise KeyError(name)
    return (resources.files("service") / "example" / f"{name}.csv").read_text(encoding="utf-8")
