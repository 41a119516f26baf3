"""The programs of a robot file."""

from pathlib import Path

import pytest

from service.files.robot_file import read_robot_file
from service.processes import from_settings
from service.processes.program import ProgramSettings
from tests.support.models import actuation_model

MODEL = actuation_model()


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, ProgramSettings]]:
    """Return what is made of each robot file."""
    found: list[dict[str, ProgramSettings]] = []
    monkeypatch.setattr(from_settings, "LocalProcesses", found.append)
    return found


def test_a_robot_file_without_programs_runs_none() -> None:
    settings = read_robot_file("nodes: {drive_base: {}}", MODEL)

    assert from_settings.make_processes(settings, None) is None


def test_folders_are_relative_to_the_robot_file(made: list[dict[str, ProgramSettings]]) -> None:
    text = (
        "nodes: {drive_base: {process: {command: [./base, -v], environment: {A: b}, stop_s: 2}},"
        " manipulator: {process: {command: [arm], cwd: ../arm}}}"
    )
    from_settings.make_processes(read_robot_file(text, MODEL), Path("/robots/gem.yaml"))

    assert made == [
        {
            "drive_base": ProgramSettings(("./base", "-v"), "/robots", {"A": "b"}, 2.0),
            "manipulator": ProgramSettings(("arm",), "/robots/../arm"),
        }
    ]
