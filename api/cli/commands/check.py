"""`pilothouse check`: errors and warnings of a model, with places that editors can jump to."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from api.cli.commands.command import Command
from api.terminal_text import complain, counted, finding_line

if TYPE_CHECKING:
    from domain.findings import Finding

VALID, INVALID, UNREADABLE = 0, 1, 2

_STANDARD_INPUT = Path("/dev/stdin")
_TEXT = """\
Check a model file: report all errors and warnings, with line and column.

exit code: 0 valid, possibly with warnings; 1 invalid;
           2 the file cannot be read
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("model", metavar="MODEL", help="model file; - reads standard input")
    parser.add_argument("--format", default="text", choices=("text", "json"))


def _run(options: argparse.Namespace) -> int:
    return check(options.model, options.format)


def check(name: str, form: Literal["text", "json"]) -> int:
    """Print the findings of a model file; return the exit code.

    Args:
        name: Path of the file; `-` is the standard input.
        form: `text` for people and editors, `json` for programs.
    """
    from api.http.schemas.inference import ModelCheckJson
    from service.files.model_file import check_model
    from service.files.text_file import UnreadableFileError, read_text_file

    try:
        text = read_text_file(_STANDARD_INPUT if name == "-" else Path(name))
    except UnreadableFileError as error:
        complain(str(error))
        return UNREADABLE
    findings = check_model(text)
    shown = ModelCheckJson.of(findings)
    if form == "json":
        print(shown.model_dump_json(indent=2))
    else:
        for finding in findings:
            print(finding_line(name, finding))
        print(f"{name}: {_verdict(findings)}")
    return VALID if shown.valid else INVALID


def _verdict(findings: Sequence["Finding"]) -> str:
    errors = sum(finding.severity == "error" for finding in findings)
    warnings = len(findings) - errors
    counts = [counted(errors, "error"), counted(warnings, "warning")]
    told = ", ".join(count for count in counts if not count.startswith("0 "))
    return f"{'invalid' if errors else 'valid'}{f' ({told})' if told else ''}"


COMMAND = Command("check", "check a model file", _TEXT, _add_options, _run)
