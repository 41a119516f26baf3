"""`pilothouse analyse`: the fault trees of a robot, with its single points of failure."""

import argparse
import sys
from typing import Literal, TypeAlias

from api.cli.commands.command import Command
from api.terminal_text import complain

COMPLETE, INCOMPLETE, UNREADABLE = 0, 1, 2

Form: TypeAlias = Literal["text", "json"]

_ABOUT = "find what leads to critical errors"
_TEXT = """\
Find what leads to each critical or fatal error of a robot: its minimal cut
sets, the smallest sets of detected, reported and built-in errors that raise
it. A set of one error is a single point of failure.

`unless` and times of the model are left out: no set is missing, and some may
be harmless in a given situation.

exit code: 0 all sets were found;
           1 a file is invalid, or an error has too many sets to list all;
           2 a file cannot be read
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("model", metavar="MODEL", help="model file; - reads standard input")
    parser.add_argument(
        "--robot", metavar="FILE", help="robot file, whose signals have errors of their own"
    )
    parser.add_argument(
        "--format", default="text", choices=("text", "json"), help="default: %(default)s"
    )


def _run(options: argparse.Namespace) -> int:
    return analyse(options.model, options.format, options.robot)


def analyse(name: str, form: Form, robot: str | None = None) -> int:
    """Print the fault trees of a model; return the exit code.

    Args:
        name: Path of the model file; `-` is the standard input.
        form: `text` for people, `json` for programs: the answer of `GET /analysis`.
        robot: Path of a robot file, or None.
    """
    from api.cli.analysis_report import report_lines
    from api.cli.checked_file import as_text
    from api.cli.robot_files import read_robot_files
    from api.http.schemas.analysis import AnalysisJson
    from domain.analysis.fault_trees import fault_trees
    from domain.supervision import Supervision, SupervisionSettings
    from service.files.text_file import UnreadableFileError

    try:
        read = read_robot_files(name, robot)
    except UnreadableFileError as error:
        complain(str(error))
        return UNREADABLE
    if read.model is None:
        for line in as_text(read.files):
            print(line, file=sys.stderr)
        return INCOMPLETE
    core = Supervision(read.model, SupervisionSettings(read.signals), 0)
    trees = fault_trees(core.error_graph())
    if form == "json":
        print(AnalysisJson.of(trees).model_dump_json(indent=2))
    else:
        for line in report_lines(name, trees):
            print(line)
    return COMPLETE if all(tree.complete_to is None for tree in trees) else INCOMPLETE


COMMAND = Command("analyse", _ABOUT, _TEXT, _add_options, _run)
