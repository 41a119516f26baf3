"""The model file and the robot file that a command was given, read and checked."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from api.cli.checked_file import CheckedFile
from domain.computers import ComputerName
from domain.devices.sub_model import LeftOut
from domain.errors import InvalidModelError, UnknownErrorNameError, UnknownSignalError
from domain.findings import Finding
from domain.health.signals import SignalSettings, default_signals
from domain.parts.system_model import SmhModel
from service.files.computer_share import left_to_supervisor
from service.files.model_file import read_model
from service.files.robot_file import InvalidRobotFileError, read_robot_file
from service.files.text_file import read_text_file

_STANDARD_INPUT = Path("/dev/stdin")
_OF_SIGNALS = frozenset({UnknownSignalError.code, UnknownErrorNameError.code})
"""Codes of warnings about names that signals of the robot file, and their errors, may have."""


@dataclass(frozen=True, slots=True)
class RobotFiles:
    """What was read of a robot."""

    files: tuple[CheckedFile, ...]
    """The model, and the robot file if it was given and checked."""
    model: SmhModel | None
    """None: a file is invalid."""
    signals: tuple[SignalSettings, ...]
    left_out: Mapping[ComputerName, tuple[LeftOut, ...]] = field(default_factory=dict)
    """By device, what the model says about its parts and it leaves to the supervisor."""


def read_robot_files(name: str, robot: str | None) -> RobotFiles:
    """Read a model, and the robot file with it; without a valid model the latter is not checked.

    Args:
        name: Path of the model file; `-` is the standard input.
        robot: Path of the robot file, or None.

    Raises:
        UnreadableFileError: A file cannot be read.
    """
    text = read_text_file(_STANDARD_INPUT if name == "-" else Path(name))
    if robot is None:
        model, findings = _read(text)
        return RobotFiles((CheckedFile(name, text, findings),), model, default_signals())
    settings_text = read_text_file(Path(robot))
    model, findings = _read(text)
    if model is None:
        return RobotFiles((CheckedFile(name, text, _decided(findings)),), None, ())
    try:
        settings = read_robot_file(settings_text, model)
    except InvalidRobotFileError as error:
        of_robot = CheckedFile(robot, settings_text, tuple(error.findings))
        return RobotFiles((CheckedFile(name, text, _decided(findings)), of_robot), None, ())
    signals = settings.to_signal_settings()
    model, findings = _read(text, signals)
    of_model, of_robot = CheckedFile(name, text, findings), CheckedFile(robot, settings_text, ())
    left_out = {} if model is None else left_to_supervisor(model, settings)
    return RobotFiles((of_model, of_robot), model, signals, left_out)


def _decided(findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """Return findings about a model without those that the signals of its robot would decide."""
    return tuple(
        each for each in findings if each.severity == "error" or each.code not in _OF_SIGNALS
    )


def _read(
    text: str, signals: tuple[SignalSettings, ...] | None = None
) -> tuple[SmhModel | None, tuple[Finding, ...]]:
    """Return a model, if it is valid, and all findings.

    Args:
        text: The text of the file.
        signals: All signals of the robot, or None, as for `read_model`.
    """
    try:
        loaded = read_model(text, signals)
    except InvalidModelError as error:
        return None, tuple(error.findings)
    return loaded.model, loaded.warnings
