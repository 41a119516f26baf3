"""The block `process` of a node in a robot file."""

import json

import pytest

from domain.parts.system_model import SmhModel
from domain.process_terms import RestartPolicy
from domain.processes.settings import ProcessSettings
from domain.timebase import seconds
from service.files.robot_file import (
    InvalidRobotFileError,
    read_robot_file,
    robot_settings_of,
    written_for_device,
    written_out,
)
from tests.support.models import BASE, actuation_model

MODEL: SmhModel = actuation_model()


def text_of(block: str) -> str:
    return f"nodes: {{drive_base: {{on_return: restore, process: {block}}}}}\n"


def complaint_of(block: str) -> str:
    with pytest.raises(InvalidRobotFileError) as caught:
        read_robot_file(text_of(block), MODEL)
    return caught.value.findings[0].message


def test_a_command_is_enough() -> None:
    settings = read_robot_file(text_of("{command: [ros2, run, base, base]}"), MODEL)

    assert settings.to_process_settings() == {BASE: ProcessSettings()}


def test_everything_that_can_be_said_is_read() -> None:
    block = (
        "{command: [base], restart: always, back_off_s: {first: 2, most: 8},"
        " budget: {starts: 9, within_s: 600}, stop_s: 0}"
    )
    settings = read_robot_file(text_of(block), MODEL).to_process_settings()[BASE]

    assert settings == ProcessSettings(
        RestartPolicy.ALWAYS, seconds(2), seconds(8), 9, seconds(600)
    )


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ("{}", "nodes.drive_base.process.command: "),
        ("{command: []}", "nodes.drive_base.process.command: "),
        ("{command: ros2 run base}", "nodes.drive_base.process.command: "),
        ('{command: [""]}', "the first word of command is the program; it is empty"),
        ("{command: [a], shell: true}", "nodes.drive_base.process.shell: unknown key"),
        ("{command: [a], restart: sometimes}", "nodes.drive_base.process.restart: "),
        ("{command: [a], back_off_s: {first: 9, most: 1}}", "first is longer than most"),
        ("{command: [a], budget: {starts: 0}}", "nodes.drive_base.process.budget.starts: "),
        ("{command: [a], environment: {1A: b}}", "nodes.drive_base.process.environment.1A"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(block: str, words: str) -> None:
    assert words in complaint_of(block)


def test_who_sends_settings_runs_no_programs_here() -> None:
    sent = {"nodes": {"drive_base": {"process": {"command": ["touch", "/tmp/x"]}}}}

    settings = robot_settings_of(sent, MODEL)

    assert settings.nodes["drive_base"].process is None
    assert settings.to_process_settings() == {}


def test_an_environment_is_kept_in_no_record() -> None:
    text = text_of("{command: [base], environment: {TOKEN: hush}}")

    for kept in (written_out(text), written_for_device(text, "arm")):
        assert "hush" not in kept
        assert json.loads(kept)["nodes"]["drive_base"]["process"] == {"command": ["base"]}
        assert json.loads(kept)["nodes"]["drive_base"]["on_return"] == "restore"


def test_a_robot_file_without_an_environment_is_kept_as_it_is() -> None:
    text = text_of("{command: [base]}")

    assert written_out(text) == text
