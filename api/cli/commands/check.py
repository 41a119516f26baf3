"""`pilothouse check`: check a model file."""

import argparse

from api.cli.commands.command import Command

_TEXT = """\
Check a model file: all that is wrong, and what is odd, with line and column.

exit code: 0 valid, perhaps with warnings; 1 invalid
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("model", metavar="MODEL", help="model file; - reads standard input")
    parser.add_argument("--format", default="text", choices=("text", "json"))


def _run(options: argparse.Namespace) -> int:
    from api.http.model_check import check

    return check(options.model, options.format)


COMMAND = Command("check", "check a model file", _TEXT, _add_options, _run)
