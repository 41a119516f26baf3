"""The description of the stream says what is the case, and shows it."""

import json
from typing import Any

import pytest

from api.documents.asyncapi import SENT, TAKEN, describe_stream, stream_document
from api.rosbridge.operations import OPERATIONS
from api.streaming.client_input import TOPICS
from tests.support.document_schemas import asyncapi_faults, leads_somewhere, references


@pytest.fixture(scope="module")
def document() -> dict[str, Any]:
    return describe_stream()


def test_it_is_asyncapi_3(document: dict[str, Any]) -> None:
    assert document["asyncapi"] == "3.0.0"
    assert json.loads(stream_document()) == document


def test_every_reference_leads_somewhere(document: dict[str, Any]) -> None:
    lost = [name for name in references(document) if not leads_somewhere(document, name)]

    assert lost == []


def test_it_tells_what_is_sent_and_what_is_taken(document: dict[str, Any]) -> None:
    told = {
        operation["action"]: [
            message["$ref"].rpartition("/")[2] for message in operation["messages"]
        ]
        for operation in document["operations"].values()
    }

    assert told == {"send": list(SENT), "receive": list(TAKEN)}


def test_it_names_what_may_be_asked_for_in_the_address(document: dict[str, Any]) -> None:
    channel = document["channels"]["stream"]
    query = channel["bindings"]["ws"]["query"]["properties"]

    assert channel["address"] == "/ws"
    assert set(query) == {"topics", "after", "epoch"}
    assert all(topic in query["topics"]["description"] for topic in TOPICS)


def test_it_names_rosbridge_whose_messages_are_described_where_the_protocol_is(
    document: dict[str, Any],
) -> None:
    channel = document["channels"]["rosbridge"]

    assert channel["address"] == "/rosbridge"
    assert "messages" not in channel
    assert all(f"`{op}`" in channel["description"] for op in OPERATIONS if op != "auth")


@pytest.mark.parametrize("name", [*SENT, *TAKEN])
def test_a_message_is_described_by_a_line_and_by_examples_that_are_right(
    name: str, document: dict[str, Any]
) -> None:
    message = document["components"]["messages"][name]
    payloads = [example["payload"] for example in message["examples"]]

    assert message["summary"].endswith(".")
    assert [payload["type"] for payload in payloads] == [name] * len(payloads) != []
    assert [fault for payload in payloads for fault in asyncapi_faults(document, payload)] == []


@pytest.mark.parametrize(
    "message",
    [
        {"type": "reading", "signal": "battery_level"},
        {"type": "reading", "signal": "battery_level", "value": None},
        {"type": "auth"},
        {"type": "hello"},
        {"type": "state", "seq": 1},
    ],
)
def test_a_message_that_lacks_something_is_none(
    message: dict[str, Any], document: dict[str, Any]
) -> None:
    assert asyncapi_faults(document, message)
