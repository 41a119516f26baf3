"""`pilothouse task` as a process of its own, beside a real service."""

import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager

import httpx

from tests.support.process import COMMAND, run, service
from tests.support.shared import PROJECT

TRACKS = PROJECT / "examples" / "tracks"


@contextmanager
def following(url: str, *options: str) -> Iterator["subprocess.Popen[str]"]:
    """Submit a long task and follow it; what a hold does to it was seen on the stream."""
    with subprocess.Popen(
        [*COMMAND, "task", str(TRACKS / "loop.csv"), "--url", url, *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    ) as process:
        try:
            read_up_to(process, "running")
            httpx.put(f"{url}/holds/operator", json={"reason": "lunch"}).raise_for_status()
            read_up_to(process, "paused: lunch")
            httpx.delete(f"{url}/holds/operator").raise_for_status()
            read_up_to(process, "running")
            yield process
        finally:
            process.kill()


def read_up_to(process: "subprocess.Popen[str]", words: str) -> None:
    """Read the output up to the line that ends so; the test limits the time."""
    assert process.stdout is not None
    next(line for line in process.stdout if line.rstrip().endswith(words))


def test_a_task_is_followed_to_its_end_and_after_ctrl_c_it_goes_on_until_it_is_canceled() -> None:
    with service() as running:
        succeeded = run("task", str(TRACKS / "short_5m.csv"), "--url", running.url)
        with following(running.url, "--start-index", "10") as process:
            process.send_signal(signal.SIGINT)
            interrupted, errors = process.communicate()
        status = httpx.get(f"{running.url}/tasks/t2").json()["status"]
        canceled = run("task", "--cancel", "--url", running.url)

    assert succeeded[0] == 0
    assert succeeded[1].endswith("task t1 after 5.0 of 5.0 m: succeeded\n")
    assert (process.returncode, errors) == (130, "")
    assert f"pilothouse task --cancel --url {running.url}" in interrupted
    assert status == "RUNNING"
    assert canceled[0] == 0
    assert canceled[1].endswith("m: canceled\n")


def test_a_service_that_is_killed_and_restarted_leaves_the_end_unknown() -> None:
    with service() as first:
        port = str(httpx.URL(first.url).port)
        with following(first.url) as process:
            first.send_signal(signal.SIGKILL)
            first.ended()
            lost = process.stdout.readline() if process.stdout else ""
            with service("--port", port):
                output, errors = process.communicate()

    assert (process.returncode, errors) == (2, "")
    assert lost == "task t1: reconnecting: the connection was lost\n"
    assert output == "task t1: what became of it is not known: the service was restarted\n"
