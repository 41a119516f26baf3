import asyncio
import logging
from collections.abc import AsyncIterator

import pytest

from domain.actor import NOBODY
from domain.computers import ComputerName
from domain.events.changes import ChangeRequested, NodeRestoring
from domain.events.devices import DeviceLost
from domain.events.event import RecordedEvent
from domain.events.parts import NodeUnreachable
from domain.state_and_mode import PartName
from service.event_log import EventLog
from service.node_incidents import log_node_incidents
from tests.support.manual_clock import settle
from tests.support.models import active


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
    restoring = NodeRestoring(PartName("manipulator"), active("STRONG"))
    events.append(RecordedEvent(1, 0, None, NOBODY, restoring))
    await settle()

    assert caplog.messages == [
        "node.restoring: manipulator reappeared and is restored to active.STRONG"
    ]
    assert caplog.records[0].levelno == logging.WARNING


async def test_what_somebody_asked_for_is_not(
    events: EventLog, caplog: pytest.LogCaptureFixture
) -> None:
    events.append(RecordedEvent(1, 0, None, NOBODY, ChangeRequested(PartName("manipulator"))))
    await settle()

    assert caplog.messages == []


async def test_of_many_events_at_once_none_is_missed(
    events: EventLog, caplog: pytest.LogCaptureFixture
) -> None:
    for number in range(1, 251):
        events.append(
            RecordedEvent(number, 0, None, NOBODY, NodeUnreachable(PartName(f"n{number}")))
        )
    await settle()

    assert caplog.messages == [
        f"node.unreachable: n{number} is unreachable" for number in range(1, 251)
    ]


async def test_of_what_is_lost_with_a_device_only_that_is_logged(
    events: EventLog, caplog: pytest.LogCaptureFixture
) -> None:
    arm = PartName("manipulator")
    lost = DeviceLost(ComputerName("arm"), "device arm has not been heard for 1.5 s")
    events.append(RecordedEvent(1, 0, None, NOBODY, lost))
    events.append(RecordedEvent(2, 0, None, NOBODY, NodeUnreachable(arm, with_device=True)))
    await settle()

    assert caplog.messages == ["device.lost: device arm has not been heard for 1.5 s"]
