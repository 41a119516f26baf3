"""The unit of systemd and its drop-in for sources, as systemd itself reads them."""

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


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with the unit, whose program exists."""
    text = (PROJECT / "docker" / UNIT).read_text()
    program = tmp_path / "pilothouse"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    (tmp_path / UNIT).write_text(text.replace("/opt/pilothouse/bin/pilothouse", str(program)))
    return tmp_path


def add_drop_in(folder: Path) -> None:
    (folder / f"{UNIT}.d").mkdir()
    shutil.copy(PROJECT / "docker" / "sources.conf", folder / f"{UNIT}.d")


def analyzed(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ("systemd-analyze", *command, f"./{UNIT}"),
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
