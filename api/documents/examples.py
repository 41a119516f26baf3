"""What the documents show as examples: recorded requests, answers and frames of the example robot.

They are in `examples.json`. A test plays them again, and fails where the robot answers otherwise.
"""

import re
from importlib import resources
from typing import Any

from api.http.schemas.base import Json


class Exchange(Json):
    """A request and its answer."""

    operation: str
    """As in the document: `POST /systems/{part}/mode`."""
    summary: str
    path: dict[str, str]
    """Values of the parameters in the path."""
    query: dict[str, str]
    body_type: str | None
    """None: without a body."""
    body: Any
    """Parsed where it is JSON, else as text."""
    status: int
    answer_type: str | None
    answer: Any


class StreamExample(Json):
    """A message of the stream."""

    message: str
    """As in the document: `state`."""
    summary: str
    payload: dict[str, Any]


class Examples(Json):
    """Everything that is shown as an example."""

    requests: list[Exchange]
    stream: list[StreamExample]


def load_examples() -> Examples:
    """Return the recorded examples, which come with the package."""
    text = (resources.files("api.documents") / "examples.json").read_bytes()
    return Examples.model_validate_json(text)


def key_of(summary: str) -> str:
    """Return the words of a summary as a name: `bring_it_to_performance`."""
    return re.sub(r"[^a-z0-9]+", "_", summary.lower()).strip("_")
