"""The clients that people use for rosbridge, against a real service: roslibpy, and npm's roslib.

Both tell the same story. The one gives its token in the handshake, the other as its first message.
"""

import json
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

import pytest

from api.access_token import TOKEN_VARIABLE
from tests.support.process import service

TOKEN = "correct-horse-battery"
ROSLIB = "2.1.0"
PROJECT = Path(__file__).resolve().parents[2]
STORIES = PROJECT / "tests" / "support" / "rosbridge_clients"
_INSTALL_S = 120
_STORY_S = 50


def roslibpy() -> Sequence[str]:
    """Return what starts the story, but for the address and the token."""
    return (sys.executable, "-m", "tests.support.rosbridge_clients.story_of_roslibpy")


def roslib() -> Sequence[str]:
    """Return the same for node, with the package in a folder that is kept."""
    node, npm = shutil.which("node"), shutil.which("npm")
    if node is None or npm is None:
        pytest.skip("there is no node, or no npm")
    folder = PROJECT / "build" / f"roslib-{ROSLIB}"
    module = folder / "node_modules" / "roslib" / "dist" / "RosLib.js"
    if not module.is_file():
        _install(npm, folder)
    return (node, str(STORIES / "story_of_roslib.mjs"), module.as_uri())


def _install(npm: str, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    options = ("--no-save", "--no-audit", "--no-fund", "--prefix", str(folder))
    command = [npm, "install", *options, f"roslib@{ROSLIB}"]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=_INSTALL_S, check=False
        )
    except subprocess.TimeoutExpired:
        pytest.skip(f"npm did not install roslib within {_INSTALL_S} s")
    if done.returncode:
        pytest.skip(f"npm cannot install roslib: {done.stderr[-500:]}")


def tell(command: Sequence[str], url: str) -> dict[str, Any]:
    """Let a client tell its story, and return what it was told."""
    done = subprocess.run(
        [*command, url.removeprefix("http://"), TOKEN],
        cwd=PROJECT,
        capture_output=True,
        text=True,
        timeout=_STORY_S,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def seconds_of(message: dict[str, Any]) -> float:
    stamp = message["header"]["stamp"]
    return float(stamp["sec"]) + float(stamp["nanosec"]) / 1e9


@pytest.mark.timeout(_INSTALL_S + _STORY_S + 10)
@pytest.mark.parametrize("client", [roslibpy, roslib])
def test_a_client_watches_the_robot_changes_its_mode_and_stops_it(
    client: Callable[[], Sequence[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    command = client()
    monkeypatch.setenv(TOKEN_VARIABLE, TOKEN)
    with service() as running:
        told = tell(command, running.url)

    assert {"/system_state", "/actuation/mode_event", "/estop"} <= set(told["topics"])
    assert abs(told["time"] - time.time()) < 60
    assert {state["state"] for state in told["states"]} == {0}
    times = map(seconds_of, told["states"])
    assert 0.045 < median(later - earlier for earlier, later in pairwise(times)) < 0.055
    assert told["changed"] == {"success": True}
    assert told["event"]["goal_mode"] == {"label": "PERFORMANCE"}
    assert "mode_name must be a text" in told["failed"]["error"]
    assert (told["status"]["level"], told["status"]["id"]) == ("error", "bad")
    assert "no such operation" in told["status"]["msg"]
    assert (told["stopped"]["state"], told["stopped"]["error_code"]) == (2, 2)
