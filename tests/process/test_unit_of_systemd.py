"""The units of systemd and their drop-ins, as systemd itself reads them."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.support.shared import PROJECT

pytestmark = pytest.mark.skipif(
    shutil.which("systemd-analyze") is None, reason="needs systemd-analyze"
)
UNIT = "pilothouse.service"
OF_A_DEVICE = "pilothouse-device@.service"
INSTANCE = "pilothouse-device@base.service"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with the unit, whose program exists."""
    program = tmp_path / "pilothouse"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    for unit in (UNIT, OF_A_DEVICE):
        text = (PROJECT / "docker" / unit).read_text()
        (tmp_path / unit).write_text(text.replace("/opt/pilothouse/bin/pilothouse", str(program)))
    # Of an instance, as after `systemctl enable`.
    (tmp_path / INSTANCE).symlink_to(OF_A_DEVICE)
    return tmp_path


def add_drop_in(folder: Path, name: str = "sources.conf", unit: str = UNIT) -> None:
    (folder / f"{unit}.d").mkdir()
    shutil.copy(PROJECT / "docker" / name, folder / f"{unit}.d")


def analyzed(folder: Path, *command: str, unit: str = UNIT) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ("systemd-analyze", *command, f"./{unit}"),
        cwd=folder,
        capture_output=True,
        check=False,
        text=True,
        timeout=50,
    )


def closed_doors(folder: Path) -> set[str]:
    """Return what the unit keeps the service from."""
    found = analyzed(folder, "security", "--offline=true", "--json=short")
    if found.returncode != 0:
        pytest.skip("this systemd-analyze does not judge files")
    return {item["json_field"] for item in json.loads(found.stdout) if item["set"]}


def test_systemd_takes_every_line_of_the_unit_and_of_the_drop_in(folder: Path) -> None:
    assert analyzed(folder, "verify").stderr == ""
    add_drop_in(folder)
    assert analyzed(folder, "verify").stderr == ""


def test_the_drop_in_opens_what_sources_need_and_nothing_else(folder: Path) -> None:
    before = closed_doors(folder)
    add_drop_in(folder)

    assert before - closed_doors(folder) == {
        "AmbientCapabilities",
        "CapabilityBoundingSet_CAP_SYS_PTRACE",
        "PrivateDevices",
        "PrivateUsers",
        "ProcSubset",
        "ProtectClock",
        "ProtectProc",
        "SystemCallFilter_clock",
    }


def test_systemd_takes_every_line_of_the_unit_of_a_device(folder: Path) -> None:
    assert analyzed(folder, "verify", unit=INSTANCE).stderr == ""
    add_drop_in(folder, "link.conf", OF_A_DEVICE)
    assert analyzed(folder, "verify", unit=INSTANCE).stderr == ""


def test_a_device_is_kept_in_as_the_supervisor_is(folder: Path) -> None:
    ours, of_device = ((folder / unit).read_text() for unit in (UNIT, OF_A_DEVICE))
    differs = ("#", "Description=", "EnvironmentFile=", "ExecStart=")

    def rest(text: str) -> list[str]:
        return [line for line in text.splitlines() if not line.startswith(differs)]

    assert rest(of_device) == rest(ours)


def test_the_drop_in_of_the_link_opens_its_keys_and_nothing_else(folder: Path) -> None:
    before = closed_doors(folder)
    add_drop_in(folder, "link.conf")

    assert before - closed_doors(folder) == {"PrivateUsers", "SupplementaryGroups"}
