import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from service.storage.errors import FolderInUseError
from service.storage.sqlite.folder_lock import FolderLock

PROJECT = Path(__file__).resolve().parents[5]
HOLDER = """
import os, sys, time
from pathlib import Path
from service.storage.sqlite.folder_lock import FolderLock
lock = FolderLock(Path(sys.argv[1]))
child = os.fork() if "fork" in sys.argv else None
if child != 0:
    print(child or os.getpid(), flush=True)
time.sleep(60)
"""


def start_holder(path: Path, *words: str) -> "subprocess.Popen[str]":
    command = [sys.executable, "-c", HOLDER, str(path), *words]
    return subprocess.Popen(command, cwd=PROJECT, stdout=subprocess.PIPE, text=True)


def test_a_lock_is_given_back(tmp_path: Path) -> None:
    lock = FolderLock(tmp_path / "lock")

    with pytest.raises(FolderInUseError, match=f"process {os.getpid()}"):
        FolderLock(tmp_path / "lock")
    lock.release()
    lock.release()

    FolderLock(tmp_path / "lock").release()


def test_a_process_that_was_killed_is_no_obstacle(tmp_path: Path) -> None:
    with start_holder(tmp_path / "lock") as holder:
        assert holder.stdout is not None
        pid = holder.stdout.readline().strip()
        with pytest.raises(FolderInUseError, match=f"in use by process {pid};"):
            FolderLock(tmp_path / "lock")
        holder.kill()

    assert (tmp_path / "lock").read_text().strip() == pid
    FolderLock(tmp_path / "lock").release()


def test_a_child_that_outlives_its_parent_does_not_hold_the_lock(tmp_path: Path) -> None:
    with start_holder(tmp_path / "lock", "fork") as holder:
        assert holder.stdout is not None
        child = int(holder.stdout.readline())
        holder.kill()
        holder.wait()
        try:
            assert is_free_soon(tmp_path / "lock")
        finally:
            os.kill(child, signal.SIGKILL)


def is_free_soon(path: Path) -> bool:
    """Wait for a child that was forked a moment ago, and may not have run yet."""
    for _ in range(500):
        try:
            FolderLock(path).release()
        except FolderInUseError:
            time.sleep(0.01)
        else:
            return True
    return False


def test_a_file_that_says_nothing_of_a_process_is_no_obstacle(tmp_path: Path) -> None:
    (tmp_path / "lock").write_bytes(b"\xff\xfe" * 100)

    FolderLock(tmp_path / "lock").release()
