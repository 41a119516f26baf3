"""The real process with the backend `ros2`; the graph is in its memory, and no ROS is needed."""

import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import httpx
import pytest

from tests.support.process import service
from tests.support.shared import PROJECT

_HARNESS = """
import asyncio
import sys
from types import SimpleNamespace
sys.path.insert(0, {project!r})
from api.cli import command_line
from service.clock import MonotonicClock
from service.ros.gateway import RosGateway
from tests.support.ros_graph import FakeGraph

graph = FakeGraph(MonotonicClock(), missing={missing!r})
sys.modules["service.ros.graph.link"] = SimpleNamespace(RosLink=lambda: graph)
{more}
raise SystemExit(command_line.main())
"""


def harness(folder: Path, more: str = "", missing: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Return the command of a `pilothouse` on a machine with ROS 2."""
    script = folder / "harness.py"
    text = _HARNESS.format(project=str(PROJECT), missing=missing, more=textwrap.dedent(more))
    script.write_text(text)
    return (sys.executable, str(script))


def test_nodes_that_are_not_there_yet_are_shown_and_the_end_is_clean(tmp_path: Path) -> None:
    with service("--backend", "ros2", command=harness(tmp_path)) as running:
        node = httpx.get(f"{running.url}/nodes/drive_base").json()
        vehicle = httpx.get(f"{running.url}/vehicle").json()
        health = httpx.get(f"{running.url}/healthz").json()
        state = httpx.get(f"{running.url}/system_state").json()
        mock = httpx.get(f"{running.url}/mock")
        body = {"from": "live", "until_s": 1, "steps": []}
        copied = httpx.post(f"{running.url}/simulations", json=body, timeout=30)

        running.send_signal(signal.SIGTERM)
        code, seconds, errors = running.ended()

    assert "ROS 2: domain" in running.greeting
    assert (node["reachable"], node["actual"]["state"]) == (False, "unknown")
    assert vehicle["pose"] is None
    assert (health["status"], state["simulated"]) == ("ok", [])
    assert mock.status_code == 404
    assert (copied.status_code, copied.json()["errors"][0]["pointer"]) == (422, "/from")
    assert code == 0
    assert seconds < 2
    # What is offered is listed, and there is nothing else to say but that a machine is busy.
    said = {line.partition(": ")[2].partition(" ")[0] for line in errors.splitlines()}
    assert said - {"skipped"} == {"ROS"}
    assert " ROS 2 /actuation: services change_mode, change_state," in errors


def test_the_mock_of_a_real_robot_makes_its_signals_good(tmp_path: Path) -> None:
    command = harness(tmp_path)
    with service("--backend", "ros2", "--mock-signals", command=command) as running:
        mock = httpx.get(f"{running.url}/mock")
        state = httpx.get(f"{running.url}/system_state").json()

    assert mock.status_code == 200
    assert (state["state"], state["simulated"]) == ("IDLE", ["signals"])


@pytest.mark.parametrize(
    ("more", "told"),
    [
        (
            """
            async def fail(self):
                await asyncio.sleep(0.3)
                raise OSError("the gate is stuck")

            RosGateway.run = fail
            """,
            "the gate is stuck",
        ),
        (
            """
            async def end(self):
                await asyncio.sleep(0.3)

            RosGateway.run = end
            """,
            "background task 'gateway' ended",
        ),
    ],
)
def test_a_gateway_that_ends_takes_the_service_with_it(
    tmp_path: Path, more: str, told: str
) -> None:
    with service("--backend", "ros2", command=harness(tmp_path, more)) as running:
        code, _, errors = running.ended()

    assert code == 1
    assert told in errors


def test_a_link_that_breaks_ends_the_service_and_is_told_in_one_line(tmp_path: Path) -> None:
    more = """
    async def fail_soon(self):
        await asyncio.sleep(0.3)
        graph.fail()
        await self._interface.run()

    RosGateway.run = fail_soon
    """
    with service("--backend", "ros2", command=harness(tmp_path, more)) as running:
        code, _, errors = running.ended()
    ours = [line for line in errors.splitlines() if "api.serving.failures" in line]

    assert code == 1
    assert [line.partition("api.serving.failures: ")[2] for line in ours] == ["the graph failed"]
    assert "GraphFailedError" not in errors


def test_a_type_that_is_not_installed_is_told_in_one_line_before_anything_runs(
    tmp_path: Path,
) -> None:
    robot = tmp_path / "robot.yaml"
    robot.write_text(
        "ros2:\n  signals:\n    temperature: {topic: /t, type: my_msgs/msg/Heat, field: degrees}\n"
    )
    command = [*harness(tmp_path, missing=("my_msgs/msg/Heat",)), "serve", "--port", "0"]
    done = subprocess.run(
        [*command, "--backend", "ros2", "--robot", str(robot)],
        capture_output=True,
        text=True,
        timeout=20,
        check=False,
    )

    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1), done.stderr
    assert "my_msgs/msg/Heat is not installed: install its package (my_msgs)" in done.stderr
