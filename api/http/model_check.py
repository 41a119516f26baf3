"""`pilothouse check`: everything that is wrong with a model, in a form that editors jump from."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from api.http.schemas.inference import ModelCheckJson
from domain.findings import Finding
from service.files.model_file import check_model
from service.files.text_file import UnreadableFileError, read_text_file

VALID, INVALID = 0, 1

_STANDARD_INPUT = Path("/dev/stdin")


def check(name: str, form: Literal["text", "json"]) -> int:
    """Print the findings of a model file; return the exit code.

    Args:
        name: Path of the file; `-` is the standard input.
        form: `text` for people and editors, `json` for programs.
    """
    try:
        text = read_text_file(_STANDARD_INPUT if name == "-" else Path(name))
    except UnreadableFileError as error:
        print(f"pilothouse: {error}", file=sys.stderr)
        return INVALID
    findings = check_model(text)
    shown = ModelCheckJson.of(findings)
    if form == "json":
        print(shown.model_dump_json(indent=2))
    else:
        for finding in findings:
            print(finding_line(name, finding))
        print(f"{name}: {_verdict(findings)}")
    return VALID if shown.valid else INVALID


def finding_line(file: str, finding: Finding) -> str:
    """Return a finding as compilers write them: `file:line:column: severity CODE message`."""
    place = f"{file}:{finding.line or 1}:{finding.column or 1}"
    return f"{place}: {finding.severity} {finding.code} {finding.message}"


def _verdict(findings: Sequence[Finding]) -> str:
    errors = sum(finding.severity == "error" for finding in findings)
    warnings = len(findings) - errors
    counts = [_count(errors, "error"), _count(warnings, "warning")]
    told = ", ".join(count for count in counts if not count.startswith("0 "))
    return f"{'invalid' if errors else 'valid'}{f' ({told})' if told else ''}"


def _count(number: int, what: str) -> str:
    return f"{number} {what}" + ("" if number == 1 else "s")
