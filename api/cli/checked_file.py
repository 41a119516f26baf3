"""Files that were checked, with the findings about them, and how they are shown."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from api.cli.excerpt import excerpt
from api.http.schemas.base import FindingJson
from api.terminal_text import counted, finding_line, visible
from domain.computers import ComputerName
from domain.devices.sub_model import LeftOut
from domain.findings import Finding
from service.files.yaml_tree import lines_of_yaml

LeftToSupervisor: TypeAlias = Mapping[ComputerName, tuple[LeftOut, ...]]
_NOTHING: LeftToSupervisor = {}
_HINT = "; did you mean "


@dataclass(frozen=True, slots=True)
class CheckedFile:
    """One file."""

    name: str
    """As it was given."""
    text: str
    findings: tuple[Finding, ...]

    @property
    def is_valid(self) -> bool:
        """Tell whether there are no errors, but perhaps warnings."""
        return all(finding.severity != "error" for finding in self.findings)


def as_text(files: Sequence[CheckedFile], left_out: LeftToSupervisor = _NOTHING) -> Iterator[str]:
    """Yield lines for people and editors, as compilers write them; the last ones sum up.

    Args:
        files: That were checked.
        left_out: What devices leave to the supervisor; that is no fault.
    """
    for file in files:
        lines = lines_of_yaml(file.text)
        for finding in file.findings:
            yield from _told(file.name, lines, finding)
    for file in files:
        yield f"{visible(file.name)}: {_verdict(file)}"
    for device, left in left_out.items():
        yield f"device {device} leaves to the supervisor:"
        yield from (visible(f"  {each.words}") for each in left)


def as_json(files: Sequence[CheckedFile], left_out: LeftToSupervisor = _NOTHING) -> str:
    """Return all findings as JSON, each with its file, and what devices leave to the supervisor."""
    findings = [
        {**FindingJson.of(finding).model_dump(), "file": file.name}
        for file in files
        for finding in file.findings
    ]
    valid = all(file.is_valid for file in files)
    left = [
        {"device": device, "what": each.what, "reason": each.reason}
        for device, all_left in left_out.items()
        for each in all_left
    ]
    return json.dumps({"valid": valid, "findings": findings, "left_out": left}, indent=2)


def _told(name: str, lines: Sequence[str], finding: Finding) -> Iterator[str]:
    message, is_hinted, hint = finding.message.rpartition(_HINT)
    yield finding_line(name, replace(finding, message=message) if is_hinted else finding)
    yield from excerpt(lines, finding.line or 1, finding.column or 1)
    if is_hinted:
        yield visible(f"      = help: did you mean {hint}")


def _verdict(file: CheckedFile) -> str:
    errors = sum(finding.severity == "error" for finding in file.findings)
    warnings = len(file.findings) - errors
    counts = [counted(errors, "error"), counted(warnings, "warning")]
    told = ", ".join(count for count in counts if not count.startswith("0 "))
    return f"{'valid' if file.is_valid else 'invalid'}{f' ({told})' if told else ''}"
