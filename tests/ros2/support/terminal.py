"""A shell that a test types commands into, one block after the other."""

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

_DONE = "--- done "


class Terminal:
    """A bash with its own variables and jobs, which end with it.

    Args:
        folder: Where it stands.
        environment: More variables. `python3` and `pilothouse` are those of this test run.
    """

    def __init__(self, folder: Path, environment: Mapping[str, str]) -> None:
        programs = Path(sys.executable).parent
        self._bash = subprocess.Popen(
            ["bash"],
            cwd=folder,
            env={**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", **environment},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            # Nodes log there, and a pipe that nobody reads would stop them.
            stderr=subprocess.DEVNULL,
            text=True,
        )

    def enter(self, commands: str) -> tuple[int, str]:
        """Run commands, and return the exit code of the last one and what all printed."""
        assert self._bash.stdin is not None
        assert self._bash.stdout is not None
        # A job must not read what is typed next.
        done = f"code=$?; echo; echo '{_DONE}'$code"
        self._bash.stdin.write(f"{{\n{commands}\n}} < /dev/null\n{done}\n")
        self._bash.stdin.flush()
        printed = ""
        for line in self._bash.stdout:
            if line.startswith(_DONE):
                return int(line.removeprefix(_DONE)), printed
            printed += line
        raise AssertionError(f"bash ended over:\n{commands}\n{printed}")

    def close(self) -> None:
        """End it and the jobs that it started."""
        assert self._bash.stdin is not None
        assert self._bash.stdout is not None
        self._bash.stdin.write("kill -KILL $(jobs -p)\n")
        self._bash.stdin.close()
        self._bash.wait(10)
        self._bash.stdout.close()
