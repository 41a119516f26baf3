"""Findings as SARIF 2.1.0, which code hosts and editors show beside the lines of a file.

Source: OASIS, Static Analysis Results Interchange Format (SARIF) Version 2.1.0.
"""

import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any, TypeAlias
from urllib.parse import quote

from api.cli.checked_file import CheckedFile
from api.distribution import installed_version
from domain.findings import Finding
from service.finding_codes.all_codes import FINDING_CODES
from service.finding_codes.finding_code import ERROR, WARNING, FindingCode

_SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
_LINK = re.compile(r"\[([^]]*)\]\([^)]*\)")

_Json: TypeAlias = Mapping[str, Any]


def as_sarif(files: Sequence[CheckedFile]) -> str:
    """Return a log with one run; its rules are the codes that were found."""
    found = [(file, finding) for file in files for finding in file.findings]
    codes = list(dict.fromkeys(finding.code for _, finding in found))
    driver = {
        "name": "pilothouse",
        "semanticVersion": installed_version(),
        "rules": [_rule(FINDING_CODES[code]) for code in codes],
    }
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "artifacts": [{"location": {"uri": _uri(file.name)}} for file in files],
        "results": [
            _result(_uri(file.name), finding, codes.index(finding.code)) for file, finding in found
        ],
    }
    return json.dumps({"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2)


def _rule(code: FindingCode) -> _Json:
    words = code.code.split("_")
    return {
        "id": code.code,
        "name": "".join(word.capitalize() for word in words),
        "shortDescription": {"text": _plain(code.meaning)},
        "help": {
            "text": _plain(f"{code.meaning} {code.mend}"),
            "markdown": _LINK.sub(r"\1", f"{code.meaning}\n\n{code.mend}"),
        },
        "defaultConfiguration": {"level": WARNING if code.severity == WARNING else ERROR},
    }


def _result(uri: str, finding: Finding, rule: int) -> _Json:
    region = {"startLine": finding.line or 1, "startColumn": finding.column or 1}
    return {
        "ruleId": finding.code,
        "ruleIndex": rule,
        "level": finding.severity,
        "message": {"text": finding.message},
        "locations": [{"physicalLocation": {"artifactLocation": {"uri": uri}, "region": region}}],
    }


def _plain(markdown: str) -> str:
    """Return text without the marks of code and links."""
    return _LINK.sub(r"\1", markdown).replace("`", "")


def _uri(name: str) -> str:
    """Return a file as a URI relative to the working directory, where that is possible."""
    if name == "-":
        return "stdin"
    try:
        relative = os.path.relpath(name)
    except ValueError:  # It is on another drive of Windows.
        return PurePath(name).as_uri()
    return quote(PurePath(relative).as_posix())
