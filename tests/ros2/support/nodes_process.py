"""A process with lifecycle nodes that a test starts, silences, kills and starts again."""

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

SCRIPT = Path(__file__).with_name("lifecycle_nodes.py")


class NodesProcess:
    """Nodes of `lifecycle_nodes.py`, in one process.

    Args:
        nodes: As it takes them, one or more.
    """

    def __init__(self, *nodes: dict[str, Any]) -> None:
        self._command = [sys.executable, str(SCRIPT), json.dumps(nodes)]
        self._process: subprocess.Popen[str] | None = None

    def start(self) -> None:
        """Start it, for the first time or again, and wait until its nodes are made."""
        self._process = subprocess.Popen(self._command, stdout=subprocess.PIPE, text=True)
        assert self._process.stdout is not None
        assert self._process.stdout.readline() == "ready\n"

    def silence(self) -> None:
        """Stop it, so that it answers nothing, though others still find it."""
        self._signal(signal.SIGSTOP)

    def go_on(self) -> None:
        """Let it go on after `silence`."""
        self._signal(signal.SIGCONT)

    def kill(self) -> None:
        """End it with SIGKILL: it has no time to say anything. It may have ended already."""
        if self._process is not None:
            self._signal(signal.SIGKILL)
            self._process.communicate()
            self._process = None

    def _signal(self, number: signal.Signals) -> None:
        assert self._process is not None
        self._process.send_signal(number)


@contextmanager
def nodes_process(*nodes: dict[str, Any], start: bool = True) -> Iterator[NodesProcess]:
    """Run nodes as long as the context lasts.

    Args:
        nodes: As of `NodesProcess`.
        start: Whether to start them at once.
    """
    process = NodesProcess(*nodes)
    try:
        if start:
            process.start()
        yield process
    finally:
        process.kill()
