"""The folder in which a robot keeps what survives a restart."""

import re
from collections.abc import Mapping
from pathlib import Path

MEMORY = ":memory:"
"""Instead of a folder: nothing survives a restart."""
USUAL = ""
"""Instead of a folder: the one that belongs to user and robot."""

_UNUSUAL = re.compile(r"[^A-Za-z0-9_.-]+")


def data_folder(chosen: str, robot: str, environment: Mapping[str, str]) -> Path | None:
    """Return the folder of a robot; None: nothing is kept.

    Args:
        chosen: A folder, `MEMORY` or `USUAL`.
        robot: Name of the robot.
        environment: Variables of the process. The usual folder is below `STATE_DIRECTORY`, which
            systemd sets, or else below `XDG_STATE_HOME`, or `~/.local/state`.
    """
    if chosen == MEMORY:
        return None
    if chosen != USUAL:
        return Path(chosen)
    name = _UNUSUAL.sub("_", robot).lstrip(".") or "robot"
    given = environment.get("STATE_DIRECTORY", "").partition(":")[0]
    if given:
        return Path(given) / name
    # A relative path is invalid by the XDG Base Directory Specification, and is not used.
    home = Path(environment.get("XDG_STATE_HOME", ""))
    state = home if home.is_absolute() else Path.home() / ".local" / "state"
    return state / "pilothouse" / name


def robot_name(named: str | None, model: Path) -> str:
    """Return the name of a robot: that in its robot file, or else that of its model file."""
    return named or model.stem
