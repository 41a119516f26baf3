"""The runners of docker/ with a real engine: podman, as docker/with_podman_here.sh sets it up."""

import os
import signal
import subprocess
from collections.abc import Iterator

import httpx
import pytest

from tests.support.runner import run, running

pytestmark = [
    pytest.mark.image,
    pytest.mark.usefixtures("engine"),
    # Of which most is for the copies that podman makes of an image in its simplest storage.
    pytest.mark.timeout(300),
]


@pytest.fixture
def engine() -> Iterator[None]:
    """Skip where podman is not set up; afterwards, end what a failed test left running."""
    if "CONTAINERS_STORAGE_CONF" not in os.environ:
        pytest.skip("podman is not set up; see `make test-image`")
    yield
    subprocess.run(
        ["podman", "rm", "--force", "--all", "--time", "0"], capture_output=True, check=True
    )


def containers() -> list[str]:
    """Return the names of all containers that podman has."""
    told = subprocess.run(
        ["podman", "ps", "--all", "--format", "{{.Names}}"],
        capture_output=True,
        text=True,
        check=True,
    )
    return told.stdout.split()


def needs(image: str) -> None:
    """Skip the test where an image was not built."""
    found = subprocess.run(["podman", "image", "exists", image], check=False)
    if found.returncode != 0:
        pytest.skip(f"{image} is not built; see docker/build_here.sh")


def test_the_demonstration_is_published_here_and_its_container_goes_with_it() -> None:
    with running("run_demo.sh") as demo:
        demo.wait_until_ready()
        changed = httpx.post(
            f"{demo.url}/systems/actuation/mode?wait=20", json={"mode": "MODERATE"}, timeout=30
        )
        code = demo.ended_by(signal.SIGTERM)

    assert changed.json()["status"] == "succeeded"
    assert (code, containers()) == (0, [])


def test_two_demonstrations_run_at_once() -> None:
    with running("run_demo.sh") as one, running("run_demo.sh") as other:
        one.wait_until_ready()
        other.wait_until_ready()
        names = containers()
        one.ended_by(signal.SIGTERM)
        other.ended_by(signal.SIGTERM)

    assert len(names) == 2


def test_the_image_runs_the_scenarios_of_the_checkout() -> None:
    done = run("run_scenarios.sh", "drive")

    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(" as expected (") == 5


def test_the_four_steps_with_ros_nodes_in_containers_of_their_own() -> None:
    needs("pilothouse-ros2")
    # Any other than that of the nodes of other tests.
    with running("run_ros2.sh", ROS_DOMAIN_ID="97") as robot:
        robot.wait_until_ready()
        robot.wait_for_nodes()
        with httpx.Client(base_url=robot.url, timeout=60) as http:
            changes = [
                http.post("/systems/actuation/state?wait=30", json={"transition": "configure"}),
                http.post("/systems/actuation/state?wait=30", json={"transition": "activate"}),
                http.post("/systems/actuation/mode?wait=30", json={"mode": "PERFORMANCE"}),
            ]
            actual = http.get("/systems/actuation").json()["actual"]
            simulated = http.get("/system_state").json()["simulated"]
        code = robot.ended_by(signal.SIGTERM)

    assert [change.json()["status"] for change in changes] == ["succeeded"] * 3
    assert (actual["state"], actual["mode"]) == ("active", "PERFORMANCE")
    assert "nodes" not in simulated
    assert (code, containers()) == (143, [])


def test_tests_run_in_the_development_image() -> None:
    needs("pilothouse-dev:0")

    done = run("run_dev.sh", "python", "-m", "pytest", "-q", "tests/unit/test_structure.py")

    assert done.returncode == 0, done.stdout + done.stderr
    assert " passed" in done.stdout


def test_the_developer_becomes_root_without_a_password() -> None:
    needs("pilothouse-dev:0")

    told = subprocess.run(
        ["podman", "run", "--rm", "pilothouse-dev:0", "sh", "-c", "id -u && sudo -n id -u"],
        capture_output=True,
        text=True,
        check=False,
    )

    assert told.stdout.split() == ["1000", "0"], told.stderr
