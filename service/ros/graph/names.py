"""Which names ROS allows; models may have others."""

import re

_ROS_NAME = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
_LONGEST = 225
"""Most characters of a name. ROS allows 247, and gives each node services whose names are up to 22
characters longer than that of the node."""


def is_allowed(name: str) -> bool:
    """Tell whether ROS allows the full name of a topic or service, or of a node with its slash."""
    return len(name) <= _LONGEST and _ROS_NAME.fullmatch(name) is not None
