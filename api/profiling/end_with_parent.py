"""Lets a process end with the one that started it, also where that is killed."""

import os
import signal
import sys
import threading


def end_with_parent() -> None:
    """Send this process a SIGTERM once standard input ends: a pipe that the parent holds open."""
    threading.Thread(target=_wait, daemon=True, name="parent").start()


def _wait() -> None:
    # It waits in the system, and keeps the interpreter from nothing.
    os.read(sys.stdin.fileno(), 1)
    os.kill(os.getpid(), signal.SIGTERM)
