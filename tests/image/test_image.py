"""The image, run: what is in it, what it may do, and that it serves."""

import os
import signal
import stat
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from api.distribution import installed_version
from tests.support.container import (
    TOKEN,
    UID,
    Container,
    ServiceInContainer,
    free_port,
    image_config,
    own_command,
    serving,
)
from tests.support.shared import PROJECT

pytestmark = pytest.mark.image

MAX_BYTES = 150_000_000
BEARER = {"Authorization": f"Bearer {TOKEN}"}


def test_it_is_ready(service: ServiceInContainer, capsys: pytest.CaptureFixture[str]) -> None:
    ready = httpx.get(f"{service.url}/readyz").json()

    with capsys.disabled():
        print(f"\nready {service.ready_s:.2f} s after the start of the container")
    assert ready["status"] == "ready"


def test_the_page_is_served(service: ServiceInContainer) -> None:
    page = httpx.get(f"{service.url}/")

    assert page.status_code == 200
    assert "<title>Pilothouse" in page.text


def test_nobody_changes_the_robot_without_the_token(service: ServiceInContainer) -> None:
    refused = httpx.post(f"{service.url}/systems/actuation/mode", json={"mode": "MODERATE"})

    assert refused.status_code == 401


def test_the_robot_is_changed_with_the_token(service: ServiceInContainer) -> None:
    changed = httpx.post(
        f"{service.url}/systems/actuation/mode?wait=20",
        json={"mode": "MODERATE"},
        headers=BEARER,
        timeout=30,
    )

    assert (changed.status_code, changed.json()["status"]) == (200, "succeeded")


def test_the_example_loop_is_driven(service: ServiceInContainer) -> None:
    # Its headings are compared with its path, for which numpy needs modules that it loads late.
    track = (PROJECT / "examples" / "tracks" / "loop.csv").read_bytes()
    headers = BEARER | {"Content-Type": "text/csv"}

    given = httpx.post(f"{service.url}/tasks", content=track, headers=headers, timeout=30)
    cancelled = httpx.delete(f"{service.url}/tasks/current", headers=BEARER)

    assert given.status_code == 201, given.text
    assert cancelled.is_success


def test_the_monitor_draws_the_robot(box: Container, service: ServiceInContainer) -> None:
    command = [*image_config()["Entrypoint"], "monitor", "--once", "--url", service.url]

    with box.start(command, environment={"PILOTHOUSE_TOKEN": TOKEN}) as monitor:
        code, said = monitor.ended()

    assert code == 0, said
    assert "drive_base" in said


def test_a_simulation_runs_in_the_process_that_is_kept_for_it(service: ServiceInContainer) -> None:
    told = httpx.post(f"{service.url}/simulations", json={"until_s": 2}, headers=BEARER, timeout=30)

    assert told.status_code == 200, told.text
    assert told.json()["samples"]


def test_without_a_token_it_says_what_is_missing_and_ends(box: Container) -> None:
    code, said = box.run(own_command("--port", str(free_port())))

    assert code == 2
    assert "PILOTHOUSE_TOKEN" in said
    assert "Traceback" not in said


def test_the_process_is_nobody_of_power(service: ServiceInContainer) -> None:
    status = Path(f"/proc/{service.process.pid}/status").read_text()
    told = dict(line.split(":\t", 1) for line in status.splitlines())

    assert told["Uid"].split() == [str(UID)] * 4
    assert told["Gid"].split() == [str(UID)] * 4
    assert int(told["CapEff"], 16) == 0


def test_the_health_check_finds_the_service(box: Container, service: ServiceInContainer) -> None:
    assert box.run(_health_check(service.port))[0] == 0


def test_the_health_check_fails_where_no_service_is(box: Container) -> None:
    assert box.run(_health_check(free_port()))[0] != 0


def test_sigterm_ends_it_well(box: Container, tmp_path: Path) -> None:
    # The other one has the folder of the image.
    with serving(box, tmp_path, "--data", "/data/second") as service:
        os.kill(service.process.pid, signal.SIGTERM)
        code, said = service.process.ended()

    assert code == 0, said
    assert "Traceback" not in said


def test_what_survives_is_in_the_volume(service: ServiceInContainer) -> None:
    storage = httpx.get(f"{service.url}/storage", headers=BEARER).json()

    assert (storage["path"], storage["degraded"]) == ("/data", False)


def test_nothing_can_be_written_outside_of_data_and_tmp(box: Container) -> None:
    writable = [path for path in _paths(box.root, {"data", "tmp"}) if _may_write(path)]

    assert [str(path) for path in writable] == []


def test_data_can_be_written(box: Container) -> None:
    code, said = box.run(["/opt/pilothouse/bin/python", "-c", "open('/data/trial', 'x')"])

    assert code == 0, said


def test_nothing_in_it_gives_more_rights_than_one_has(box: Container) -> None:
    special = [
        path
        for path in _paths(box.root, set())
        if path.is_file() and path.lstat().st_mode & (stat.S_ISUID | stat.S_ISGID)
    ]

    assert special == []


@pytest.mark.parametrize("program", ["sh", "bash", "pip", "apt-get", "curl"])
def test_it_holds_no_tool_that_an_intruder_would_like(box: Container, program: str) -> None:
    assert [path for path in _paths(box.root, set()) if path.name == program] == []


def test_it_is_small(box: Container, capsys: pytest.CaptureFixture[str]) -> None:
    size = sum(path.lstat().st_size for path in _paths(box.root, set()))

    with capsys.disabled():
        print(f"\nthe image has {size / 1e6:.1f} MB unpacked")
    assert size < MAX_BYTES


@pytest.mark.usefixtures("box")
def test_it_says_which_version_it_is() -> None:
    labels = image_config()["Labels"]

    assert labels["org.opencontainers.image.version"] == installed_version()


@pytest.mark.usefixtures("box")
def test_it_lets_nobody_in_by_itself() -> None:
    config = image_config()

    assert "--anonymous" not in [*config["Entrypoint"], *config["Cmd"]]
    assert not any("TOKEN" in variable for variable in config["Env"])


def _health_check(port: int) -> list[str]:
    """Return the health check of the image, for a service on another port than 8000."""
    kind, *command = image_config()["Healthcheck"]["Test"]
    assert kind == "CMD"
    return [part.replace("8000", str(port)) for part in command]


def _paths(root: Path, without: set[str]) -> Iterator[Path]:
    """Walk through all that is in the image, besides some folders at its root."""
    for path in root.iterdir():
        if path.name not in without:
            yield path
            if path.is_dir() and not path.is_symlink():
                yield from path.rglob("*")


def _may_write(path: Path) -> bool:
    found = path.lstat()
    if stat.S_ISLNK(found.st_mode):
        return False
    mine = found.st_uid == UID and found.st_mode & stat.S_IWUSR
    ours = found.st_gid == UID and found.st_mode & stat.S_IWGRP
    return bool(mine or ours or found.st_mode & stat.S_IWOTH)
