"""The built-in tracks, for a simulated vehicle that starts at the origin."""

from collections.abc import Mapping
from importlib import resources
from types import MappingProxyType

TRACKS: Mapping[str, str] = MappingProxyType({"loop": "A loop of 800 m"})
"""Titles by name. A name is never used as a path: only these files are opened."""


def track_text(name: str) -> str:
    """Return one of `TRACKS` as CSV: x, y in m, yaw in rad.

    Raises:
        KeyError: There is no track of that name.
    """
    if name not in TRACKS:
        raise KeyError(name)
    return (resources.files("service") / "example" / f"{name}.csv").read_text(encoding="utf-8")
