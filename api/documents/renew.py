"""Write the documents of the interface to files.

    python -m api.documents.renew [FOLDER]

writes `openapi.json` and `asyncapi.json` to `docs/reference`, or to another folder.
"""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from api.app import create_app
from api.documents.asyncapi import describe_stream
from api.serving.composition import ServeOptions, compose
from service.clock import MonotonicClock

_FOLDER = Path("docs", "reference")


def documents() -> Mapping[str, str]:
    """Return the texts of the documents by the names of their files."""
    app = create_app(compose(ServeOptions(), MonotonicClock()).supervisor, allowed_hosts=[])
    return {"openapi.json": _text(app.openapi()), "asyncapi.json": _text(describe_stream())}


def _text(document: Mapping[str, Any]) -> str:
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def renew(folder: Path) -> None:
    """Write the documents to `folder`."""
    for name, text in documents().items():
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    renew(Path(sys.argv[1]) if len(sys.argv) > 1 else _FOLDER)
