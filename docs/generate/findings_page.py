"""Findings: what is wrong or doubtful in model files, robot files and waypoint files."""

from collections.abc import Iterable

from docs.generate.markdown import code, page, table
from service.finding_codes.file_codes import ALL_FILES, ROBOT_FILES, WAYPOINT_FILES
from service.finding_codes.finding_code import FindingCode
from service.finding_codes.model_codes import MODES, PARTS, RULES, YAML
from service.finding_codes.settings_codes import CONDITIONS, ERRORS, REACTIONS, SETTINGS

_INTRODUCTION = """\
`pilothouse check MODEL`, `POST /model/check` and the start of the service report all errors at
once, each as `file:line:column: severity[CODE]: message`. A model with errors is rejected; a model
with warnings still runs. Codes are stable.

Pilothouse reads every file that the C++ of micro-ROS system_modes accepts, except files on which
the C++ would crash or that it would misread. In the tables, *C++* names the behaviour of that
implementation."""
_SETTINGS = """\
Extensions are keys beside `type`, `parts`, `modes` and `rules` of a part: `mode_settings`, `errors`
and `reactions`. C++ ignores what they mean."""
_ERRORS = """\
The block `errors` of a part has the codes of settings and conditions, and these."""
_CONDITIONS = """\
Conditions stand in `requires` and `invariants` of modes, and in the `errors` and `reactions` of
parts. A finding points at the character inside the condition, or at its start where it is folded
over several lines."""
_ROBOT_FILES = """\
Robot files have the codes of YAML, `UNKNOWN_KEY`, `INVALID_VALUE`, `UNKNOWN_SIGNAL`,
`UNKNOWN_PART`, `UNKNOWN_MODE`, `UNKNOWN_ERROR` and these.
[robot-file.schema.json](robot-file.schema.json) lists all keys."""
_WAYPOINT_FILES = """\
[Waypoint files](../how-to/waypoint-files.md) says how files are read. At most 20 findings are
reported, one for each line. `POST /tasks` rejects a file with any of them, and so does
`POST /tasks/preview`, except for `HEADINGS_MISFIT`, which is a warning there."""


def findings_page() -> str:
    """Return the page on all codes of findings."""
    return page(
        "Findings of models, robot files and waypoint files",
        _INTRODUCTION,
        *_section("YAML", "", YAML),
        *_section("Parts", "", PARTS),
        *_section("Modes", "", MODES),
        *_section("Rules", "", RULES),
        *_section("Settings of modes, and other extensions", _SETTINGS, SETTINGS),
        *_section("Errors of parts", _ERRORS, ERRORS),
        *_section("Reactions", "", REACTIONS),
        *_section("Conditions", _CONDITIONS, CONDITIONS),
        *_section("Robot files", _ROBOT_FILES, ROBOT_FILES),
        *_section("Waypoint files", _WAYPOINT_FILES, WAYPOINT_FILES),
        *_section("All files", "", ALL_FILES),
    )


def _section(title: str, introduction: str, codes: Iterable[FindingCode]) -> Iterable[str]:
    yield f"## {title}"
    if introduction:
        yield introduction
    rows = ((code(own.code), own.severity, own.meaning, own.mend) for own in codes)
    yield table(("code", "severity", "meaning", "how to mend"), rows)
