"""The console script as a process of its own, beside a real service: an operator at a terminal."""

import json
import os
import shutil
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest

from tests.support.big_model import big_model_text
from tests.support.process import COMMAND, ServiceProcess, run, service
from tests.support.shared import PROJECT

TRACK = str(PROJECT / "examples" / "tracks" / "loop.csv")
TOKEN = "3f1c9b6e5d0a4c8f9e7b2a1d6c5f4e3b"


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> Iterator[ServiceProcess]:
    """Return a service that PILOTHOUSE_URL names."""
    with service() as running:
        monkeypatch.setenv("PILOTHOUSE_URL", running.url)
        yield running


@contextmanager
def started(*arguments: str) -> Iterator["subprocess.Popen[str]"]:
    """Run `pilothouse` as long as the context lasts, with its output in pipes."""
    with subprocess.Popen(
        [*COMMAND, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port: int = listener.getsockname()[1]
    return port


def drive(robot: ServiceProcess) -> None:
    """Let the vehicle drive, and wait until it is under way."""
    assert run("task", TRACK, "--no-wait")[0] == 0
    while not (httpx.get(f"{robot.url}/vehicle").json()["speed_mps"] or 0) > 0.5:
        time.sleep(0.05)


def test_a_vehicle_is_stopped_and_drives_again_after_the_release(robot: ServiceProcess) -> None:
    drive(robot)

    stopped = run("stop", "dog", "on", "the", "track", "--wait", "20")
    why = run("why")
    released = run("release", "--reason", "it ran away")

    assert stopped[0] == 0, stopped
    assert stopped[1].startswith("stop engaged ")
    assert stopped[1].endswith("the vehicle stands still\n")
    assert why[0] == 1
    assert "dog on the track" in why[1]
    assert (released[0], released[1].splitlines()[0]) == (0, "the emergency stop is released")
    assert httpx.get(f"{robot.url}/emergency_stop").json()["engaged"] is False


def test_a_task_is_held_and_goes_on(robot: ServiceProcess) -> None:
    drive(robot)

    assert run("hold", "lunch", "break")[0] == 0
    assert "held by operator: lunch break" in run("hold", "--list")[1]
    assert httpx.get(f"{robot.url}/tasks/current").json()["reason"] == "lunch break"
    mistyped = run("release", "operater")
    assert mistyped[0] == 1
    assert "there is no hold of owner 'operater'" in mistyped[2]
    assert run("release", "operator")[1].splitlines()[0] == "the hold of operator is released"
    assert run("hold", "--list")[1] == "no holds\n"


def test_an_error_is_seen_acknowledged_and_shelved(robot: ServiceProcess) -> None:
    reading = run("signal", "battery_level", "42%")
    assert reading[0] == 0
    assert reading[1].splitlines()[-1] == "the robot is ERROR: BATTERY_LOW"

    assert run("errors")[0] == 1
    waiting = run("ack")
    assert waiting[0] == 1
    assert "BATTERY_LOW" in waiting[1]
    assert run("ack", "BATTERY_LOW")[0] == 0
    assert run("ack")[:2] == (0, "no error waits for it\n")
    assert run("shelve", "BATTERY_LOW", "--reason", "on the bench")[0] == 0
    assert "not announced (1)" in run("errors")[1]
    assert run("shelve", "--end", "BATTERY_LOW")[0] == 0
    assert robot.runs


def test_programs_get_one_json_object_from_a_command(robot: ServiceProcess) -> None:
    commands = (
        ("why",),
        ("signal", "battery_level", "0.9"),
        ("errors",),
        ("mode", "actuation", "PERFORMANCE"),
        ("task", TRACK, "--no-wait"),
        ("stop", "dog"),
        ("release",),
        ("monitor", "--once"),
    )
    for command in commands:
        code, output, errors = run(*command, "--format", "json")
        assert code in (0, 1), (command, errors)
        assert output.count("\n") == 1, command
        assert isinstance(json.loads(output), dict), command
    assert robot.runs


def test_events_are_followed_line_by_line_into_a_pipe(robot: ServiceProcess) -> None:
    with started("events", "--follow", "--kind", "hold.*", "--format", "json") as following:
        assert following.stdout is not None
        while True:
            run("hold", "lunch")
            told = json.loads(following.stdout.readline())
            if told["data"]["owner"] == "operator":
                break
        run("release", "operator")
        while json.loads(following.stdout.readline())["kind"] != "hold.released":
            pass
        following.send_signal(signal.SIGINT)
        _, errors = following.communicate()
    assert (following.returncode, errors) == (0, "")
    assert robot.runs


def test_a_stop_is_tried_until_the_service_is_there() -> None:
    port = str(free_port())
    url = f"http://127.0.0.1:{port}"
    with started("stop", "--url", url, "--retry", "60", "--wait", "30") as stopping:
        assert stopping.stderr is not None
        assert "try 1: no service answers" in stopping.stderr.readline()
        # Read on, or the pipe fills while the service starts.
        told: list[str] = []
        reader = threading.Thread(target=lambda: told.extend(stopping.stderr or ()))
        reader.start()
        with service("--port", port):
            output = stopping.stdout.read() if stopping.stdout else ""
            assert stopping.wait(60) == 0
            assert httpx.get(f"{url}/emergency_stop").json()["engaged"] is True
        reader.join()
    assert output.startswith("stop engaged ")
    assert told[-1].startswith("pilothouse: try ")


def test_without_a_service_the_hardware_stop_is_named() -> None:
    code, output, errors = run("stop", "--url", f"http://127.0.0.1:{free_port()}", "--retry", "1")

    assert (code, output) == (2, "")
    assert errors.splitlines()[-1] == "pilothouse: Not delivered. Use the hardware stop."
    assert errors.count("try ") >= 2


def test_a_service_that_hangs_leaves_it_open_whether_it_was_delivered() -> None:
    with service() as running:
        running.send_signal(signal.SIGSTOP)
        code, _, errors = run("stop", "--url", running.url, "--retry", "1")
        running.send_signal(signal.SIGCONT)

    assert code == 2
    assert errors.splitlines()[-1] == (
        "pilothouse: It is not known whether the stop was delivered. Use the hardware stop."
    )


def test_ctrl_c_between_tries_says_that_it_is_not_known() -> None:
    url = f"http://127.0.0.1:{free_port()}"
    with started("stop", "--url", url, "--retry", "60") as stopping:
        assert stopping.stderr is not None
        stopping.stderr.readline()
        stopping.send_signal(signal.SIGINT)
        output, errors = stopping.communicate()

    assert (stopping.returncode, output) == (130, "")
    assert errors.splitlines()[-1].endswith(
        "It is not known whether the stop was delivered. Use the hardware stop."
    )


def test_a_stop_needs_the_token_of_the_service(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PILOTHOUSE_TOKEN", TOKEN)
    with service() as running:
        accepted = run("stop", "--url", running.url)
        monkeypatch.delenv("PILOTHOUSE_TOKEN")
        refused = run("stop", "--url", running.url)

    assert accepted[0] == 0
    assert refused[0] == 1
    assert "PILOTHOUSE_TOKEN" in refused[2]
    assert "Not delivered. Use the hardware stop." in refused[2]
    assert TOKEN not in "".join((*accepted[1:], *refused[1:]))


def test_a_mode_of_many_nodes_is_told_as_a_count(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = tmp_path / "robot.yaml"
    model.write_text(big_model_text(200))
    with service(str(model)) as running:
        monkeypatch.setenv("PILOTHOUSE_URL", running.url)
        root = httpx.get(f"{running.url}/systems").json()["items"][0]["name"]
        code, output, errors = run("mode", root, "FAST")

    lines = output.splitlines()
    assert (code, errors) == (0, "")
    assert lines[-2:] == ["200 of 200 nodes", f"{root}: succeeded; it is active.FAST now"]
    assert len(lines) < 20


# --- completion ----------------------------------------------------------------------------------

BASH = """
eval "$(pilothouse completion bash)"
COMP_LINE="$1" COMP_POINT=${#1} COMP_TYPE=9
_python_argcomplete pilothouse
printf '%s\\n' "${COMPREPLY[@]}"
"""
FISH = "pilothouse completion fish | source; complete -C $argv[1]"


def completed(shell: str, line: str) -> set[str]:
    """Return what a shell offers to follow on a line."""
    script = {"bash": ["bash", "-c", BASH, "bash"], "fish": ["fish", "-c", FISH]}[shell]
    path = f"{Path(COMMAND[0]).parent}:{os.environ['PATH']}"
    done = subprocess.run(
        [*script, line],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PATH": path},
    )
    assert done.stderr == ""
    return {word.partition("\t")[0].strip() for word in done.stdout.splitlines()}


@pytest.mark.parametrize("shell", ["bash", "fish"])
def test_a_shell_completes_commands_and_the_names_of_the_robot(
    shell: str, robot: ServiceProcess
) -> None:
    if shutil.which(shell) is None:
        pytest.skip(f"there is no {shell} on this machine")

    assert completed(shell, "pilothouse rel") == {"release"}
    assert completed(shell, "pilothouse mode ") == {"actuation", "drive_base", "manipulator"}
    assert completed(shell, "pilothouse why actuation PERF") == {"PERFORMANCE"}
    assert robot.runs


def test_zsh_can_read_its_script() -> None:
    if shutil.which("zsh") is None:
        pytest.skip("there is no zsh on this machine")

    script = run("completion", "zsh")[1]

    assert subprocess.run(["zsh", "-n"], input=script, text=True, check=False).returncode == 0


def test_a_tracker_without_ros_2_says_what_to_do_about_it() -> None:
    code, _, complaints = run("tracker", "--tracker", "stanley")

    assert code == 2
    assert "source the setup.bash of your ROS 2 distribution" in complaints
    assert "Traceback" not in complaints
