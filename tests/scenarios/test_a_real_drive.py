"""`pilothouse task` against a real `pilothouse serve`."""

import signal
import subprocess
import time
from collections.abc import Iterator
from typing import IO

import httpx
import pytest

from tests.support.process import COMMAND, ServiceProcess, run, service
from tests.support.shared import PROJECT

TRACKS = PROJECT / "examples" / "tracks"


@pytest.fixture
def serving() -> Iterator[ServiceProcess]:
    with service() as process:
        yield process


def test_a_drive_is_followed_to_its_end_and_the_next_one_is_left_and_canceled(
    serving: ServiceProcess,
) -> None:
    code, told, complaints = run("task", str(TRACKS / "short_5m.csv"), "--url", serving.url)

    assert (code, complaints) == (0, "")
    assert told.splitlines()[-1] == "task t1 after 5.0 of 5.0 m: succeeded"

    # The vehicle stands 5 m from where the loop begins, and so may begin there.
    watched = subprocess.Popen(
        [*COMMAND, "task", str(TRACKS / "loop.csv"), "--start-index", "10", "--url", serving.url],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=hear_ctrl_c,
    )
    assert watched.stdout is not None
    # The task may move before its client has read the answer.
    until_told(watched.stdout, "task t2")
    until_running(serving)
    watched.send_signal(signal.SIGINT)
    told, complaints = watched.communicate(timeout=10)

    assert (watched.returncode, complaints) == (130, "")
    assert "task t2 goes on; to cancel it: pilothouse task --cancel" in told

    code, told, _ = run("task", "--cancel", "--url", serving.url)
    assert (code, told.split(" ")[1]) == (0, "t2")
    assert told.endswith(": canceled\n")


def test_waypoints_that_cannot_be_driven_are_refused(serving: ServiceProcess) -> None:
    code, told, complaints = run(
        "task", str(TRACKS / "loop.csv"), "--start-index", "100", "--url", serving.url
    )

    assert code == 1
    assert "1600 waypoints" in told
    assert complaints.startswith("rejected: ")
    assert "Traceback" not in complaints


def hear_ctrl_c() -> None:
    """Undo what is inherited where the tests run in the background: there Ctrl-C is ignored."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def until_told(lines: IO[str], words: str) -> None:
    """Read lines until one has `words`."""
    for line in lines:
        if words in line:
            return
    raise AssertionError(f"{words!r} was never told")


def until_running(serving: ServiceProcess) -> None:
    """Wait until the task t2 moves."""
    for _ in range(100):
        answer = httpx.get(f"{serving.url}/tasks/current")
        if answer.is_success and answer.json()["distance_m"] > 0:
            return
        time.sleep(0.1)
    raise AssertionError("the task never moved")
