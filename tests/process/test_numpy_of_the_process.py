"""A service at rest has not loaded numpy; the first task makes it do so."""

import sys
from pathlib import Path

import httpx
import pytest

from tests.support.process import ServiceProcess, service

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")

CSV = {"Content-Type": "text/csv"}
LINE = "0,0,0\n5,0,0\n20,0,0\n"


def has_numpy(process: ServiceProcess) -> bool:
    return "/numpy/" in Path(f"/proc/{process.pid}/maps").read_text()


def test_numpy_is_loaded_by_the_first_task() -> None:
    with service() as running, httpx.Client(base_url=running.url) as http:
        begun_with = has_numpy(running)
        for path in ("/readyz", "/tasks", "/vehicle", "/storage", "/metrics", "/events?limit=10"):
            http.get(path).raise_for_status()
        watched_with = has_numpy(running)
        # The work of another process.
        http.post("/tasks/preview", content=LINE, headers=CSV).raise_for_status()
        previewed_with = has_numpy(running)
        task = http.post("/tasks", content=LINE, headers=CSV).raise_for_status().json()
        driven_with = has_numpy(running)

    assert (begun_with, watched_with, previewed_with, driven_with) == (False, False, False, True)
    assert task["waypoint_count"] == 3
