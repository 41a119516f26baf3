"""What the service is given and gives, as JSON: documents of the interface, and robot files."""

import json
from collections.abc import Mapping
from typing import Any

from api.app import create_app
from api.documents.asyncapi import describe_stream
from api.serving.composition import ServeOptions, compose, read_files
from docs.generate.robot_schema import robot_schema
from service.clock import MonotonicClock


def openapi_document() -> str:
    """Return the text of `openapi.json`."""
    options = ServeOptions()
    composition = compose(options, MonotonicClock(), read_files(options))
    app = create_app(composition.supervisor, allowed_hosts=[])
    return _text(app.openapi())


def asyncapi_document() -> str:
    """Return the text of `asyncapi.json`."""
    return _text(describe_stream())


def robot_file_schema() -> str:
    """Return the text of `robot-file.schema.json`."""
    schema = robot_schema()
    return _text({"$schema": "https://json-schema.org/draft/2020-12/schema", **schema})


def _text(document: Mapping[str, Any]) -> str:
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"
