"""The runners of docker/, without a container; tests/image runs them with one."""

import shutil
import signal
import subprocess
from pathlib import Path

import httpx
import pytest

from tests.support.runner import FOLDER, environment, run, running
from tests.support.shared import PROJECT

RUNNERS = sorted(path.name for path in FOLDER.glob("run_*.sh"))


@pytest.mark.skipif(shutil.which("shellcheck") is None, reason="there is no shellcheck")
def test_shellcheck_finds_nothing() -> None:
    done = subprocess.run(
        ["shellcheck", "--external-sources", *sorted(FOLDER.glob("*.sh"))],
        capture_output=True,
        text=True,
        check=False,
    )

    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("name", RUNNERS)
def test_a_runner_explains_itself(name: str) -> None:
    told = run(name, "--help")

    assert (told.returncode, told.stderr) == (0, "")
    assert f"docker/{name} [" in told.stdout
    assert "set -euo" not in told.stdout


@pytest.mark.parametrize("name", RUNNERS)
def test_a_runner_rejects_what_it_does_not_know(name: str) -> None:
    refused = run(name, "--turbo")

    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr == f"{name}: unknown option '--turbo'; --help lists what there is\n"


def test_the_last_option_needs_its_value() -> None:
    refused = run("run_demo.sh", "--port")

    assert (refused.returncode, refused.stderr) == (2, "run_demo.sh: --port needs a value\n")


def test_without_an_engine_it_says_what_to_do(tmp_path: Path) -> None:
    for tool in ("bash", "dirname", "env", "id"):
        (tmp_path / tool).symlink_to(shutil.which(tool) or "")

    refused = run("run_demo.sh", PATH=str(tmp_path))

    assert refused.returncode == 2
    assert "--here runs without a container" in refused.stderr


def test_the_demonstration_is_a_robot_that_can_be_driven_and_leaves_nothing() -> None:
    with running("run_demo.sh", "--here") as demo:
        demo.wait_until_ready()
        changed = httpx.post(
            f"{demo.url}/systems/actuation/mode?wait=20", json={"mode": "MODERATE"}, timeout=30
        )
        code = demo.ended_by(signal.SIGTERM)
        left = demo.left_behind()

    assert changed.json()["status"] == "succeeded"
    assert (code, left) == (0, [])


@pytest.mark.timeout(120)
def test_the_scenarios_of_a_set_end_as_expected() -> None:
    done = run("run_scenarios.sh", "--here", "drive")

    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(" as expected (") == 5
    assert "error_during_the_drive.yaml" in done.stdout


@pytest.fixture
def reader(tmp_path: Path) -> str:
    """Return a PATH with a `pilothouse` that only prints its scenario, and fails with one."""
    program = tmp_path / "pilothouse"
    program.write_text('#!/bin/sh\necho "$2"\n[ "${2##*/}" != annex4_step2.yaml ]\n')
    program.chmod(0o755)
    return f"{tmp_path}:{environment({})['PATH']}"


def test_every_scenario_is_in_one_set(reader: str) -> None:
    scenarios = sorted(str(path) for path in (PROJECT / "examples" / "scenarios").glob("*.yaml"))

    done = run("run_scenarios.sh", "--here", PATH=reader)

    assert sorted(done.stdout.splitlines()) == scenarios


def test_a_scenario_that_fails_fails_the_run_and_those_after_it_are_run(reader: str) -> None:
    done = run("run_scenarios.sh", "--here", "modes", PATH=reader)

    assert done.returncode == 1
    assert len(done.stdout.splitlines()) == 5


def test_an_unknown_set_is_rejected() -> None:
    refused = run("run_scenarios.sh", "--here", "parking")

    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr == "run_scenarios.sh: unknown set 'parking'; see --help\n"
