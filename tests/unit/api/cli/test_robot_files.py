from pathlib import Path

import pytest

from api.cli.robot_files import read_robot_files
from service.files.text_file import UnreadableFileError
from tests.support.http_robot import ACTUATION

LOAD = "signals: {load: {error: OVERLOAD, above: 10}}\n"


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "model.yaml"
    path.write_text(ACTUATION)
    return path


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    path = tmp_path / "robot.yaml"
    path.write_text(LOAD)
    return path


def test_a_model_alone_has_the_five_usual_signals(model: Path) -> None:
    read = read_robot_files(str(model), None)

    assert read.model is not None
    assert [file.is_valid for file in read.files] == [True]
    assert len(read.signals) == 5


def test_a_robot_file_brings_its_signals(model: Path, robot: Path) -> None:
    read = read_robot_files(str(model), str(robot))

    assert read.model is not None
    assert [file.name for file in read.files] == [str(model), str(robot)]
    assert read.signals[-1].spec.name == "load"


def test_without_a_valid_model_the_robot_file_is_not_checked(model: Path, robot: Path) -> None:
    model.write_text(ACTUATION.replace("\ndrive_base:", "\nwheels:"))
    robot.write_text("nodes: {nobody: {}}\n")

    read = read_robot_files(str(model), str(robot))

    assert read.model is None
    assert [(file.name, file.is_valid) for file in read.files] == [(str(model), False)]


def test_an_invalid_robot_file_is_told_beside_the_model(model: Path, robot: Path) -> None:
    robot.write_text("nodes: {nobody: {}}\n")

    read = read_robot_files(str(model), str(robot))

    assert read.model is None
    assert [file.is_valid for file in read.files] == [True, False]


@pytest.mark.parametrize(
    ("of_model", "of_robot"),
    [("parts: []", LOAD), ("", "nodes: {nobody: {}}\n" + LOAD)],
)
def test_of_signals_that_were_not_read_none_is_said_to_be_unknown(
    model: Path, robot: Path, of_model: str, of_robot: str
) -> None:
    hot = '      errors: {HOT: {when: "load > 5"}, WORSE: {when: "error.OVERLOAD"}}\n'
    model.write_text(f"drive:\n  ros__parameters:\n      type: node\n{hot}{of_model}\n")
    robot.write_text(of_robot)

    read = read_robot_files(str(model), str(robot))

    assert read.model is None
    found = [finding.code for file in read.files for finding in file.findings]
    assert len(found) == 1
    assert found[0] not in ("UNKNOWN_SIGNAL", "UNKNOWN_ERROR")


def test_a_file_that_is_not_there_is_told(model: Path) -> None:
    with pytest.raises(UnreadableFileError):
        read_robot_files(str(model), "/nowhere/robot.yaml")


def test_what_a_device_leaves_to_the_supervisor_is_found(model: Path, robot: Path) -> None:
    guard = "    mode_settings: {STRONG: {requires: [battery_level > 0.2]}}\n"
    model.write_text(f"{ACTUATION}{guard}")
    robot.write_text("devices: {arm: {parts: [manipulator]}, base: {parts: [drive_base]}}\n")

    read = read_robot_files(str(model), str(robot))

    assert {device: [each.reason for each in left] for device, left in read.left_out.items()} == {
        "arm": ["battery_level is not its own"]
    }
