"""All generated files, by their name in `docs/reference`."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from docs.generate.blockers_page import blockers_page
from docs.generate.command_line_page import command_line_page
from docs.generate.events_page import events_page
from docs.generate.findings_page import findings_page
from docs.generate.interface_documents import (
    asyncapi_document,
    openapi_document,
    robot_file_schema,
)
from docs.generate.metrics_page import metrics_page
from docs.generate.problems_page import problems_page
from docs.generate.settings_page import settings_page

FOLDER = Path(__file__).resolve().parents[1] / "reference"

PAGES: Mapping[str, Callable[[], str]] = MappingProxyType(
    {
        "asyncapi.json": asyncapi_document,
        "blockers.md": blockers_page,
        "command-line.md": command_line_page,
        "events.md": events_page,
        "findings.md": findings_page,
        "metrics.md": metrics_page,
        "openapi.json": openapi_document,
        "problems.md": problems_page,
        "robot-file.schema.json": robot_file_schema,
        "settings.md": settings_page,
    }
)
