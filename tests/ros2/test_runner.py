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
        robot.signal_one("manipulator.py", signal.SIGKILL)
        code = robot.ended()
        left = robot.left_behind()

    assert code != 0
    assert left == []


def test_a_node_that_does_not_end_is_killed() -> None:
    with running("run_ros2.sh", "--here") as robot:
        robot.wait_until_ready()
        robot.signal_one("manipulator.py", signal.SIGSTOP)
        code = robot.ended_by(signal.SIGTERM)
        left = robot.left_behind()
        said = robot.said()

    assert (code, left) == (143, [])
    assert "killing what has not ended" in said
