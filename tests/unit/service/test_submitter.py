"""What is handed to the core, and what follows from it."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.computers import ComputerName
from domain.devices.settings import DeviceSettings
from domain.errors import UnknownPartError
from domain.inputs import ModeRequest, NodeReport, Reading, Readings, Restored
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from domain.timebase import Instant
from service.catch_up import CatchUp
from service.refused_readings import RefusedReadings
from service.storage.journal import Step
from service.submitter import Submitter
from service.supervisor import Supervisor
from tests.support.live_robot import make_onboard, make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.models import ARM, BASE, actuation_model


class Given:
    """A submitter on a clock, and the outputs that were to be carried out."""

    def __init__(self, settings: SupervisionSettings | None = None) -> None:
        self.clock = ManualClock()
        self.onboard = make_onboard(actuation_model(), self.clock.now(), settings)
        self.carried_out: list[Step] = []
        self.tick_due: Instant | None = None
        catch_up = CatchUp(self.clock, lambda: self.tick_due)
        self.refused = RefusedReadings()
        self.submitter = Submitter(
            self.onboard, self.clock, self.carried_out.append, catch_up, self.refused
        )


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def supervisor(clock: ManualClock) -> AsyncIterator[Supervisor]:
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        yield supervisor


async def test_what_was_due_before_a_refused_request_is_still_told(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    supervisor.readings.submit([Reading("estop", value=True)])
    supervisor.readings.submit([Reading("estop", value=False)])
    await clock.advance(0.19)
    clock.stall(0.02)
    with pytest.raises(UnknownPartError):
        supervisor.submit(ModeRequest(PartName("nobody"), "FAST"))
    kinds = [event.kind for event in supervisor.events.oldest_first()]
    assert "error.cleared" in kinds[-3:]


def test_what_follows_is_carried_out_and_returned() -> None:
    given = Given()
    given.submitter.deliver(NodeReport(BASE, reachable=True))
    outputs = given.submitter.submit(ModeRequest(BASE, "FAST"))

    assert given.carried_out[-1].outputs == outputs
    assert outputs.change is not None


def test_a_report_that_is_refused_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    given = Given()
    given.submitter.deliver(NodeReport(PartName("nobody"), reachable=True))

    assert "rejected NodeReport" in caplog.text
    assert given.onboard.core.part(BASE).reachable is False


def test_a_refused_reading_of_a_topic_is_counted(caplog: pytest.LogCaptureFixture) -> None:
    given = Given()
    given.submitter.deliver(Readings((Reading("battery_level", 7.0),), "ros:/battery"))

    assert given.refused.counts == {"ros": 1}
    assert "rejected a reading of ros:/battery" in caplog.text


async def test_what_time_makes_due_happens_at_its_time() -> None:
    given = Given()
    run = asyncio.create_task(given.submitter.run())
    given.submitter.submit(Readings((Reading("estop", value=True),), "test"))
    given.submitter.submit(Readings((Reading("estop", value=False),), "test"))
    await given.clock.advance(0.19)
    assert "ESTOP" in given.onboard.core.system_state().errors
    await given.clock.advance(0.01)
    assert "ESTOP" not in given.onboard.core.system_state().errors
    run.cancel()
    await asyncio.wait([run])


def test_what_an_earlier_run_left_comes_before_what_fell_due_while_the_service_was_made() -> None:
    arm = DeviceSettings(ComputerName("arm"), (ARM,))
    given = Given(SupervisionSettings(devices={arm.name: arm}))
    # Longer than devices are waited for.
    given.clock.stall(10.0)
    given.submitter.begin(Restored(boot=2, next_event=500))

    first, *_ = (event.id for step in given.carried_out for event in step.outputs.events)
    assert first == 500
    assert [step.is_late for step in given.carried_out] == [True]


def test_where_nothing_fell_due_what_an_earlier_run_left_is_not_late() -> None:
    given = Given()
    given.submitter.begin(Restored(next_event=500))

    assert [step.is_late for step in given.carried_out] == [False]
