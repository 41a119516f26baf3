"""Keeps the nodes of the tests apart from all others."""

import os
import tempfile

DOMAINS = 101
"""The numbers from 1 on that work on every system."""


def isolate() -> None:
    """Let this process, and those that it starts, meet only each other in the ROS 2 graph.

    Another run on the same machine has another process id, and so another domain as a rule. The
    workers of one run are numbered, and never share one.
    """
    worker = os.environ.get("PYTEST_XDIST_WORKER")
    number = os.getpid() if worker is None else os.getppid() + int(worker.removeprefix("gw"))
    os.environ["ROS_DOMAIN_ID"] = str(1 + number % DOMAINS)
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    if "ROS_LOG_DIR" not in os.environ:
        os.environ["ROS_LOG_DIR"] = tempfile.mkdtemp(prefix="pilothouse-ros-")
