"""docker/run_ros2.sh without containers; tests/image runs it with them."""

import signal

import httpx
import pytest

from tests.support.runner import running

pytestmark = [pytest.mark.ros2, pytest.mark.timeout(120)]


def test_the_example_nodes_are_changed_and_all_processes_end_with_the_runner() -> None:
    with running("run_ros2.sh", "--here") as robot:
        robot.wait_until_ready()
        robot.wait_for_nodes()
        with httpx.Client(base_url=robot.url, timeout=60) as http:
            changed = http.post("/systems/actuation/mode?wait=30", json={"mode": "PERFORMANCE"})
            simulated = http.get("/system_state").json()["simulated"]
        code = robot.ended_by(signal.SIGTERM)
        left = robot.left_behind()

    assert changed.json()["status"] == "succeeded", changed.text
    assert "nodes" not in simulated
    assert (code, left) == (143, [])


def test_the_death_of_a_node_ends_all() -> None:
    with running("run_ros2.sh", "--here") as robot:
        robot.wait_until_ready()
        robot.wait_for_nodes()
        robot.kill_one("manipulator.py")
        code = robot.ended()
        left = robot.left_behind()

    assert code != 0
    assert left == []
