"""An end of the link only carries: what it hears, it hands to its machine, and what that says, it
sends and delivers, at the time that the machine asks for."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.commands import AskFacts
from domain.computers import SUPERVISOR, ComputerName, Incarnation
from domain.inputs import NodeReport, ReportBacklog
from domain.link.messages import Beat, Report, Terms
from domain.link.outputs import NOTHING, LinkOutputs, Sending
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.link.end import MAX_WAITING, LinkEnd
from service.link.status import LinkStatus
from service.link.wire import decode
from service.pacing import AT_ONCE
from service.ports import BackendMessage
from tests.support.manual_clock import ManualClock, settle
from tests.support.models import ARM
from tests.support.scripted_machine import DeadEnd, ScriptedMachine

THERE = ComputerName("arm")
RUN = Incarnation("1" * 32)
BEAT = Beat(THERE, RUN, 1, Terms("model", "ownership"))
REPORT = Report(THERE, RUN, 2, (NodeReport(ARM, reachable=True),))


class RunningEnd:
    """An end that runs, with everything around it."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.machine = ScriptedMachine()
        self.link = DeadEnd()
        self.delivered: list[BackendMessage] = []
        status = LinkStatus({THERE: seconds(0.1)})
        self.end = LinkEnd(self.machine, self.link, self.clock, status)


@pytest.fixture
async def here() -> AsyncIterator[RunningEnd]:
    here = RunningEnd()
    run = asyncio.create_task(here.end.run(here.delivered.append), name="end")
    await settle()
    yield here
    run.cancel()
    await asyncio.wait([run])
    assert run.cancelled()


def reports(count: int) -> tuple[NodeReport, ...]:
    return tuple(NodeReport(PartName(f"node{n}"), reachable=True) for n in range(count))


async def test_a_message_is_handed_to_the_machine_and_what_follows_to_the_core(
    here: RunningEnd,
) -> None:
    report = NodeReport(ARM, reachable=True)
    here.machine.answer = lambda: LinkOutputs(inputs=(report,))
    here.link.hear(THERE, REPORT)
    await settle()

    assert here.machine.heard == [(THERE, REPORT)]
    assert here.delivered == [report]


async def test_what_is_no_message_is_counted_and_hurts_nobody(here: RunningEnd) -> None:
    assert here.link.deliver is not None
    here.link.deliver(THERE, b"j{")
    here.link.hear(THERE, BEAT)

    assert here.machine.heard == [(THERE, BEAT)]
    assert here.end.connection(THERE).dropped == 1


async def test_a_command_is_sent_at_once_but_the_core_is_told_in_a_later_turn(
    here: RunningEnd,
) -> None:
    report = NodeReport(ARM, reachable=False)
    here.machine.answer = lambda: LinkOutputs((Sending(THERE, REPORT),), (report,))
    here.end.send(AskFacts(1, ARM))

    assert [(to, decode(text), lost) for to, text, lost in here.link.sent] == [
        (THERE, REPORT, False)
    ]
    assert here.delivered == []
    await settle()
    assert here.delivered == [report]


async def test_of_all_messages_only_a_beat_may_be_lost(here: RunningEnd) -> None:
    here.machine.answer = lambda: LinkOutputs((Sending(THERE, BEAT), Sending(THERE, REPORT)))
    here.end.send(AskFacts(1, ARM))

    assert [may_be_lost for _, _, may_be_lost in here.link.sent] == [True, False]


async def test_the_machine_acts_at_exactly_the_time_that_it_asks_for(here: RunningEnd) -> None:
    here.machine.rang_at.clear()
    at = here.machine.due = here.clock.now() + seconds(0.3)
    here.end.send(AskFacts(1, ARM))
    await here.clock.advance(1.0)

    assert here.machine.rang_at == [at]


async def test_a_message_that_cannot_be_written_does_not_keep_back_the_next(
    here: RunningEnd,
) -> None:
    bad = Report(THERE, RUN, 3, (NodeReport(PartName("\ud800")),))
    here.machine.answer = lambda: LinkOutputs((Sending(THERE, bad), Sending(THERE, REPORT)))
    here.end.send(AskFacts(1, ARM))

    assert [decode(text) for _, text, _ in here.link.sent] == [REPORT]


async def test_of_very_many_inputs_some_are_delivered_in_each_turn(here: RunningEnd) -> None:
    many = reports(2 * AT_ONCE + 1)
    before = here.clock.now()
    await here.clock.advance(1.0)
    here.machine.answer = lambda: LinkOutputs(inputs=many)
    here.link.hear(THERE, REPORT)
    turns, seen = 0, 0
    while seen < len(many):
        await asyncio.sleep(0)
        came = sum(isinstance(message, NodeReport) for message in here.delivered)
        assert came - seen <= AT_ONCE
        turns += came > seen
        seen = came
    await settle()

    assert turns == 3
    first, *others, last = here.delivered
    assert isinstance(first, ReportBacklog)
    assert first.since is not None
    assert before <= first.since <= here.clock.now()
    assert others == list(many)
    assert last == ReportBacklog("link", None)


async def test_as_long_as_very_much_waits_only_beats_are_heard(here: RunningEnd) -> None:
    here.machine.answer = lambda: LinkOutputs(inputs=reports(MAX_WAITING))
    here.link.hear(THERE, REPORT)
    here.machine.answer = lambda: NOTHING
    here.link.hear(THERE, REPORT)
    here.link.hear(THERE, BEAT)

    assert here.machine.heard == [(THERE, REPORT), (THERE, BEAT)]
    assert here.end.connection(THERE).dropped == 1
    await settle()
    here.link.hear(THERE, BEAT)
    assert here.machine.heard[-1] == (THERE, BEAT)


async def test_what_the_core_raises_ends_the_run() -> None:
    here = RunningEnd()

    def fail(message: BackendMessage) -> None:
        if isinstance(message, NodeReport):
            raise LookupError

    here.machine.answer = lambda: LinkOutputs(inputs=reports(1))
    run = asyncio.create_task(here.end.run(fail), name="end")
    await settle()
    here.link.hear(SUPERVISOR, BEAT)
    await settle()

    with pytest.raises(ExceptionGroup) as caught:
        run.result()
    assert caught.group_contains(LookupError)


async def test_messages_and_times_that_change_nothing_deliver_nothing(here: RunningEnd) -> None:
    here.machine.answer = lambda: NOTHING
    here.link.hear(THERE, BEAT)
    await here.clock.advance(1.0)

    assert here.delivered == []


async def test_what_the_link_dropped_is_counted_with_what_cannot_be_read(here: RunningEnd) -> None:
    here.link.dropped = {THERE: 3}
    assert here.link.deliver is not None
    here.link.deliver(THERE, b"")

    assert here.end.connection(THERE).dropped == 4
