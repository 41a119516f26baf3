"""What becomes the program of a node: it tells the guard first."""

import os
import subprocess
import sys
from pathlib import Path

from service.processes import program_child

FILE = Path(program_child.__file__)


def test_it_tells_the_guard_its_group_and_hides_the_pipe_from_the_program() -> None:
    ours, theirs = os.pipe()
    command = ("sh", "-c", f"echo $$; [ -e /proc/self/fd/{theirs} ] && echo open; true")
    ended = subprocess.run(
        [sys.executable, "-I", "-S", str(FILE), str(theirs), "/", *command],
        pass_fds=(theirs,),
        capture_output=True,
        text=True,
        check=True,
        timeout=20,
    )
    os.close(theirs)

    with open(ours) as told:
        assert told.read() == f"+{ended.stdout.strip()}\n"


def test_without_a_guard_it_runs_nothing() -> None:
    ended = subprocess.run(
        [sys.executable, "-I", "-S", str(FILE), "99", "/", "echo", "hello"],
        capture_output=True,
        text=True,
        check=False,
        timeout=20,
    )

    assert (ended.returncode, ended.stdout) == (program_child.NOT_RUN, "")
