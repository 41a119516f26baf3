import asyncio
import logging
from collections.abc import AsyncIterator

import pytest

from domain.events import Event
from service.event_log import EventLog
from service.node_incidents import log_node_incidents
from tests.support.manual_clock import settle


@pytest.fixture
async def events() -> AsyncIterator[EventLog]:
    log = EventLog()
    logging_ = asyncio.create_task(log_node_incidents(log), name="log")
    await settle()
    yield log
    logging_.cancel()
    await asyncio.wait([logging_])


async def test_a_node_that_moves_by_itself_is_in_the_log(
    events: EventLog, caplog: pytest.LogCaptureFixture
) -> None:
    data = {"node": "manipulator", "target": "active.STRONG"}
    events.append(Event(1, 0, "node.restoring", None, "", data))
    await settle()

    assert caplog.messages == ["node.restoring: node manipulator, target active.STRONG"]
    assert caplog.records[0].levelno == logging.WARNING


async def test_what_somebody_asked_for_is_not(
    events: EventLog, caplog: pytest.LogCaptureFixture
) -> None:
    events.append(Event(1, 0, "change.requested", None, "", {"part": "manipulator"}))
    await settle()

    assert caplog.messages == []


async def test_of_many_events_at_once_none_is_missed(
    events: EventLog, caplog: pytest.LogCaptureFixture
) -> None:
    for number in range(1, 251):
        events.append(Event(number, 0, "node.unreachable", None, "", {"node": f"n{number}"}))
    await settle()

    assert caplog.messages == [f"node.unreachable: node n{number}" for number in range(1, 251)]
