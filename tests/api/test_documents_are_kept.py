"""What the documents show is what the robot does."""

import asyncio
import json
from typing import Any

import pytest

from api.documents.asyncapi import SENT, describe_stream
from api.documents.examples import Examples, load_examples
from api.documents.openapi import operations_of
from domain.simulation.node_settings import Fault
from tests.support.document_examples import record
from tests.support.document_schemas import asyncapi_faults
from tests.support.document_story import SHORT_TASK, STORY
from tests.support.http_robot import HttpRobot
from tests.support.websocket import WebSocketClient


@pytest.fixture(scope="module")
def recorded() -> Examples:
    return asyncio.run(record())


@pytest.mark.parametrize("number", range(len(STORY)), ids=lambda n: f"{n}: {STORY[n].operation}")
def test_a_request_is_answered_as_it_is_shown(number: int, recorded: Examples) -> None:
    """Where it is right that it is not: `python -m tests.support.document_examples`."""
    shown = load_examples().requests[number]

    assert rounded(recorded.requests[number]) == rounded(shown)


def test_messages_are_as_they_are_shown(recorded: Examples) -> None:
    assert [*map(rounded, recorded.stream)] == [*map(rounded, load_examples().stream)]


def test_every_operation_is_in_the_story(robot: HttpRobot) -> None:
    told = {asked.operation for asked in STORY}

    assert told == {name for name, _ in operations_of(robot.app.openapi())}


async def test_every_message_of_an_eventful_time_is_as_described(robot: HttpRobot) -> None:
    document = describe_stream()
    async with WebSocketClient(robot.app, after=0, epoch="an-earlier-one") as client:
        await robot.bring_to("actuation", "PERFORMANCE")
        await robot.http.post("/tasks", json=SHORT_TASK)
        await robot.pass_time(2)
        robot.break_node("manipulator", Fault.SILENT)
        client.send({"type": "reading", "signal": "battery_level", "value": 0.1})
        client.send({"type": "reading"})
        await robot.pass_time(3)
        await robot.http.delete("/tasks/current")
        await robot.pass_time(1)
        messages = client.frames()

    assert {message["type"] for message in messages} == set(SENT)
    states = [message for message in messages if message["type"] == "state"]
    assert {True, False} == {"parts" in state for state in states}
    assert {None} < {
        state["task"] and state["task"]["status"] for state in states if "task" in state
    }
    assert [fault for message in messages for fault in asyncapi_faults(document, message)] == []


def rounded(value: Any) -> object:  # noqa: ANN401
    """Return a model as JSON, without the last bits of numbers, which another machine has too."""
    return json.loads(value.model_dump_json(), parse_float=lambda text: round(float(text), 6))
