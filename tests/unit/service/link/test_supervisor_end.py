"""The devices are a backend of nodes to the supervisor."""

import asyncio

from domain.commands import AskFacts
from domain.inputs import BackendStatus, NodeReport
from service.link.status import LinkStatus
from service.link.supervisor_end import RemoteNodes, SupervisorEnd
from service.ports import BackendMessage
from tests.support.manual_clock import ManualClock, settle
from tests.support.models import ARM
from tests.support.scripted_machine import DeadEnd, ScriptedMachine


def make_end(machine: ScriptedMachine) -> SupervisorEnd:
    return SupervisorEnd(machine, DeadEnd(), ManualClock(), LinkStatus({}))


def test_a_command_for_a_node_is_told_to_the_machine() -> None:
    machine = ScriptedMachine()
    RemoteNodes(make_end(machine)).send(AskFacts(1, ARM))

    assert machine.told == [AskFacts(1, ARM)]


def test_what_the_supervisor_learns_is_told_to_nobody() -> None:
    machine = ScriptedMachine()
    make_end(machine).note(NodeReport(ARM, reachable=True))

    assert machine.noted == []


async def test_remote_nodes_deliver_nothing_by_themselves_until_they_are_cancelled() -> None:
    delivered: list[BackendMessage] = []
    run = asyncio.create_task(RemoteNodes(make_end(ScriptedMachine())).run(delivered.append))
    await settle()

    assert not run.done()
    run.cancel()
    await asyncio.wait([run])
    assert delivered == []


async def test_it_says_first_that_devices_can_be_reached_at_all() -> None:
    delivered: list[BackendMessage] = []
    run = asyncio.create_task(make_end(ScriptedMachine()).run(delivered.append))
    await settle()
    run.cancel()
    await asyncio.wait([run])

    assert delivered == [BackendStatus(available=True)]
