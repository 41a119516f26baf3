"""`pilothouse check`: errors and warnings of a model, with places that editors can jump to."""

import argparse
import io
import sys
from typing import Literal, TypeAlias

from api.cli.commands.command import Command
from api.terminal_text import complain

VALID, INVALID, UNREADABLE = 0, 1, 2

Form: TypeAlias = Literal["text", "json", "sarif"]

_TEXT = """\
Check a model file: report all errors and warnings, with line and column.

With --robot, check the robot file too, and the conditions of the model
against its signals: an unknown signal is an error then, and a warning
without. What a device of the robot leaves to its supervisor is listed.

exit code: 0 valid, possibly with warnings; 1 invalid;
           2 a file cannot be read
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("model", metavar="MODEL", help="model file; - reads standard input")
    parser.add_argument(
        "--robot", metavar="FILE", help="robot file, whose signals conditions may name"
    )
    parser.add_argument(
        "--format",
        default="text",
        choices=("text", "json", "sarif"),
        help="text for people and editors; json and sarif (2.1.0) for programs",
    )


def _run(options: argparse.Namespace) -> int:
    return check(options.model, options.format, options.robot)


def check(name: str, form: Form, robot: str | None = None) -> int:
    """Print the findings of a model file; return the exit code.

    Args:
        name: Path of the file; `-` is the standard input.
        form: `text` for people and editors, `json` and `sarif` for programs.
        robot: Path of a robot file, or None.
    """
    from api.cli.checked_file import as_json, as_text
    from api.cli.robot_files import read_robot_files
    from api.cli.sarif import as_sarif
    from service.files.text_file import UnreadableFileError

    try:
        read = read_robot_files(name, robot)
    except UnreadableFileError as error:
        complain(str(error))
        return UNREADABLE
    if isinstance(sys.stdout, io.TextIOWrapper):
        # Lines of the file may hold what the encoding of the terminal cannot show.
        sys.stdout.reconfigure(errors="replace")
    if form == "json":
        print(as_json(read.files, read.left_out))
    elif form == "sarif":
        print(as_sarif(read.files))
    else:
        for line in as_text(read.files, read.left_out):
            print(line)
    return VALID if all(file.is_valid for file in read.files) else INVALID


COMMAND = Command("check", "check a model file", _TEXT, _add_options, _run)
