"""The example of three computers, as its how-to says: three terminals, and a fourth to ask from."""

import subprocess
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import httpx
import pytest

from tests.support.process import COMMAND, ServiceProcess, device, service
from tests.support.robot_of_computers import free_port
from tests.support.shared import PROJECT

pytest.importorskip("zenoh", reason="the extra `link` is not installed")
pytestmark = pytest.mark.timeout(180)

EXAMPLE = PROJECT / "examples" / "three_computers"
PATIENCE_S = 30.0


@pytest.fixture
def computers(tmp_path: Path) -> Iterator[tuple[ServiceProcess, ServiceProcess]]:
    """Yield the supervisor and the device `base` of the example, whose `arm` runs as well."""
    robot = tmp_path / "robot.yaml"
    link = f"link: {{connect: [tcp/127.0.0.1:{free_port()}]}}\n"
    robot.write_text((EXAMPLE / "robot.yaml").read_text() + link)
    files = (str(EXAMPLE / "model.yaml"), "--robot", str(robot), "--data", ":memory:")
    starts = (
        partial(service, *files, "--mock-signals"),
        partial(device, "base", *files),
        partial(device, "arm", *files),
    )
    with ExitStack() as stack, ThreadPoolExecutor() as threads:
        supervisor, base, _ = threads.map(lambda start: stack.enter_context(start()), starts)
        yield supervisor, base


def run(computer: ServiceProcess, *arguments: str) -> tuple[int, str]:
    """Run a command against a service."""
    command = (*COMMAND, *arguments, "--url", computer.url)
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    return done.returncode, done.stdout


def wait_for(what: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE_S
    while not what():
        assert time.monotonic() < end
        time.sleep(0.1)


def test_who_asks_for_devices_sees_what_becomes_of_them(
    computers: tuple[ServiceProcess, ServiceProcess],
) -> None:
    supervisor, base = computers
    wait_for(lambda: run(supervisor, "devices")[0] == 0)
    assert run(base, "devices") == (
        0,
        "device base: the supervisor's word counts\n"
        "when cut off: after 2 s: drive_base to inactive; its reactions act\n",
    )
    assert run(supervisor, "mode", "mobile_manipulation", "TRANSPORT")[0] == 0

    base.kill()
    wait_for(lambda: "base    lost " in run(supervisor, "devices")[1])

    code, listed = run(supervisor, "devices")
    assert code == 1
    assert "arm     connected" in listed
    part = httpx.get(f"{supervisor.url}/nodes/drive_base").json()
    assert (part["device"], part["reachable"]) == ("base", False)
    assert part["last_known"] == {"state": "active", "mode": "FAST"}
    metrics = httpx.get(f"{supervisor.url}/metrics").text
    assert 'pilothouse_device_connected{device="base"} 0.0' in metrics
    assert 'pilothouse_device_connected{device="arm"} 1.0' in metrics


def test_a_device_without_its_supervisor_says_that_it_acts_alone(
    computers: tuple[ServiceProcess, ServiceProcess],
) -> None:
    supervisor, base = computers
    wait_for(lambda: run(supervisor, "devices")[0] == 0)
    assert run(supervisor, "mode", "drive_base", "FAST")[0] == 0

    supervisor.kill()

    wait_for(lambda: run(base, "devices")[1].startswith("device base: acts alone"))
    wait_for(lambda: _state(base) == "inactive")
    assert run(base, "devices")[0] == 1


def test_a_motor_that_is_hot_on_its_device_is_not_cold_at_the_supervisor(
    computers: tuple[ServiceProcess, ServiceProcess],
) -> None:
    supervisor, base = computers
    wait_for(lambda: run(supervisor, "devices")[0] == 0)
    motor = f"{supervisor.url}/signals/motor_temperature"
    posted = httpx.post(f"{base.url}/signals/motor_temperature", json={"value": 95})
    assert posted.status_code == httpx.codes.OK
    wait_for(lambda: bool(httpx.get(motor).json()["value"] == 95))

    refused = httpx.post(motor, json={"value": 10})

    assert (refused.status_code, refused.json()["code"]) == (409, "ACTS_ELSEWHERE")
    time.sleep(1.5)  # so that everything was reported once more
    shown = httpx.get(motor).json()
    assert (shown["value"], shown["error"]) == (95.0, "MOTOR_HOT")


def _state(computer: ServiceProcess) -> str:
    return str(httpx.get(f"{computer.url}/nodes/drive_base").json()["actual"]["state"])
