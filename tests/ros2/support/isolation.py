"""Keeps the nodes of the tests apart from all others."""

import os
import tempfile

DOMAINS = 101
"""The numbers from 1 on that work on every system."""


def isolate() -> None:
    """Let this process, and those that it starts, meet only each other in the ROS 2 graph.

    Another run on the same machine has another process id, and so another domain as a rule.
    """
    os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % DOMAINS)
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    if "ROS_LOG_DIR" not in os.environ:
        os.environ["ROS_LOG_DIR"] = tempfile.mkdtemp(prefix="pilothouse-ros-")
