"""The AsyncAPI document: what goes over `/ws`, from the models of what is sent and taken.

What goes over `/rosbridge` is named only.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema
from pydantic_core import to_json

from api.distribution import installed_version
from api.documents.examples import Examples, key_of, load_examples
from api.documents.wording import LICENSE, ROSBRIDGE, STREAM, STREAM_QUERY
from api.http.schemas.stream import (
    AuthMessage,
    EventJson,
    GapJson,
    HelloJson,
    ProblemFrame,
    ReadingMessage,
    ResyncMessage,
    StateFrame,
)

SENT: Mapping[str, type[BaseModel]] = MappingProxyType(
    {
        "hello": HelloJson,
        "state": StateFrame,
        "event": EventJson,
        "gap": GapJson,
        "problem": ProblemFrame,
    }
)
"""What Pilothouse sends, by the `type` of the message."""

TAKEN: Mapping[str, type[BaseModel]] = MappingProxyType(
    {"auth": AuthMessage, "reading": ReadingMessage, "resync": ResyncMessage}
)
"""What a client may send."""

_ROSBRIDGE: Mapping[str, str] = MappingProxyType(
    {
        "address": "/rosbridge",
        "title": "rosbridge",
        "description": ROSBRIDGE,
    }
)
"""Without messages: those are described where the protocol is."""

_CHANNEL = {"$ref": "#/channels/stream"}
_PATH = "/ws"


def describe_stream() -> dict[str, Any]:
    """Return the AsyncAPI document; it says nothing about the robot that is served."""
    messages = {**SENT, **TAKEN}
    return {
        "asyncapi": "3.0.0",
        "info": {
            "title": "Pilothouse",
            "version": installed_version(),
            "description": STREAM,
            "license": {
                "name": LICENSE["name"],
                "url": "https://www.apache.org/licenses/LICENSE-2.0",
            },
        },
        "defaultContentType": "application/json",
        "channels": {"stream": _channel(messages), "rosbridge": dict(_ROSBRIDGE)},
        "operations": {
            "sendToClient": _operation("send", SENT, "What a client is sent, in order."),
            "takeFromClient": _operation("receive", TAKEN, "What a client may send."),
        },
        "components": {
            "messages": _messages(messages, load_examples()),
            "schemas": _schemas(),
        },
    }


def stream_document() -> bytes:
    """Return the text of the AsyncAPI document."""
    return to_json(describe_stream())


def _channel(messages: Mapping[str, object]) -> dict[str, Any]:
    return {
        "address": _PATH,
        "title": "The stream",
        "description": "Text messages, one JSON object each.",
        "messages": {name: {"$ref": f"#/components/messages/{name}"} for name in messages},
        "bindings": {
            "ws": {
                "method": "GET",
                "query": {"type": "object", "properties": dict(STREAM_QUERY)},
                "bindingVersion": "0.1.0",
            }
        },
    }


def _operation(action: str, messages: Mapping[str, object], summary: str) -> dict[str, Any]:
    return {
        "action": action,
        "channel": _CHANNEL,
        "summary": summary,
        "messages": [{"$ref": f"#/channels/stream/messages/{name}"} for name in messages],
    }


def _messages(models: Mapping[str, type[BaseModel]], examples: Examples) -> dict[str, Any]:
    return {
        name: {
            "name": name,
            "title": name.capitalize(),
            "summary": " ".join((model.__doc__ or "").partition("\n\n")[0].split()),
            "payload": {"$ref": f"#/components/schemas/{model.__name__}"},
            "examples": [
                {"name": key_of(item.summary), "summary": item.summary, "payload": item.payload}
                for item in examples.stream
                if item.message == name
            ],
        }
        for name, model in models.items()
    }


def _schemas() -> dict[str, Any]:
    """Return the schemas of the messages, as they go over the wire, and of all they hold."""
    _, document = models_json_schema(
        [
            *((model, "serialization") for model in SENT.values()),
            *((model, "validation") for model in TAKEN.values()),
        ],
        ref_template="#/components/schemas/{model}",
    )
    schemas: dict[str, Any] = document["$defs"]
    return schemas
