"""Ends the programs of nodes once the service has ended, however it did; run as a file.

The service, and each program until it has begun, hold the other end of the pipe that is the
standard input. What comes through it are lines: `+` or `-` and the number of a process group.
"""

import os
import signal
import sys
import time
from contextlib import suppress

PATIENCE_S = 1.0
"""Time between SIGINT and SIGKILL: the next service may start by then."""
PAUSE_S = 0.02


def main() -> None:
    """Wait for the end of the service, then end what it has left behind."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        signal.signal(getattr(signal, name), signal.SIG_IGN)
    groups: set[int] = set()
    for line in sys.stdin:
        change = groups.add if line[0] == "+" else groups.discard
        change(int(line[1:]))
    send(groups, signal.SIGINT)
    end = time.monotonic() + PATIENCE_S
    while send(groups, 0) and time.monotonic() < end:
        time.sleep(PAUSE_S)
    send(groups, signal.SIGKILL)


def send(groups: set[int], number: int) -> bool:
    """Send a signal to groups; return whether there is any. 0 sends nothing."""
    found = False
    for group in groups:
        with suppress(ProcessLookupError):
            os.killpg(group, number)
            found = True
    return found


if __name__ == "__main__":
    main()
