"""The documents of the interface, as the service gives them: `openapi.json` and `asyncapi.json`."""

import json
from collections.abc import Mapping
from typing import Any

from api.app import create_app
from api.documents.asyncapi import describe_stream
from api.serving.composition import ServeOptions, compose
from service.clock import MonotonicClock


def openapi_document() -> str:
    """Return the text of `openapi.json`."""
    app = create_app(compose(ServeOptions(), MonotonicClock()).supervisor, allowed_hosts=[])
    return _text(app.openapi())


def asyncapi_document() -> str:
    """Return the text of `asyncapi.json`."""
    return _text(describe_stream())


def _text(document: Mapping[str, Any]) -> str:
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"
