"""The supervisor in virtual time: what arrives is decided at once, the tick only publishes."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable

import pytest

from domain.commands import Drive, NodeCommand
from domain.errors import InvalidValueError, UnknownChangeError, UnknownPartError
from domain.identifiers import ChangeId
from domain.inputs import (
    BackendStatus,
    EmergencyStopRequest,
    HoldRequest,
    ModeRequest,
    NodeReport,
    Reading,
    TaskRequest,
)
from domain.simulation.robot import SimulatedRobot
from domain.snapshot import ChangeStatus, SystemState
from domain.state_and_mode import PartName
from domain.tasks.holds import MAX_HOLDS
from service.files.model_file import LoadedModel
from service.frame_feed import Frame
from service.ports import BackendMessage
from service.supervisor import Supervisor, TaskFailedError
from tests.support.live_robot import make_onboard, make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.models import ACTUATION, BASE, PERFORMANCE, actuation_model
from tests.support.paths import straight


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def supervisor(clock: ManualClock) -> AsyncIterator[Supervisor]:
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        yield supervisor


class Recorded:
    """Every frame that a supervisor publishes."""

    def __init__(self, supervisor: Supervisor) -> None:
        self.frames: list[Frame] = []
        self._supervisor = supervisor

    def __call__(self) -> None:
        newest = self._supervisor.frames.newest
        assert newest is not None
        self.frames.append(newest)


async def test_ten_seconds_are_200_frames_without_a_gap(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    recorded = Recorded(supervisor)
    first = supervisor.snapshot_seq
    with supervisor.frames.watch(recorded):
        await clock.advance(10)
    assert [f.seq for f in recorded.frames] == list(range(first + 1, first + 201))
    assert supervisor.late_ticks == 0


async def test_one_frame_a_second_is_complete(clock: ManualClock, supervisor: Supervisor) -> None:
    recorded = Recorded(supervisor)
    with supervisor.frames.watch(recorded):
        await clock.advance(3)
    full = [frame for frame in recorded.frames if frame.full]
    assert len(full) == 3
    assert all(set(frame.parts) == set(supervisor.model.parts) for frame in full)


async def test_a_frame_in_between_holds_what_changed_and_nothing_else(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    await clock.advance(0.31)
    recorded = Recorded(supervisor)
    with supervisor.frames.watch(recorded):
        supervisor.submit(ModeRequest(BASE, "FAST"))
        await clock.advance(0.05)
    (frame,) = recorded.frames
    assert set(frame.parts) == {BASE, ACTUATION}


async def test_an_error_is_published_at_once_and_not_at_the_next_tick(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    await clock.advance(0.01)
    before = supervisor.snapshot_seq
    supervisor.submit_readings([Reading("estop", value=True)])
    newest = supervisor.frames.newest
    assert newest is not None
    assert newest.seq == before + 1
    assert newest.system_state.state is SystemState.ERROR


async def test_the_first_frame_of_a_robot_with_the_mock_is_idle(supervisor: Supervisor) -> None:
    newest = supervisor.frames.newest
    assert newest is not None
    assert (newest.system_state.state, newest.full) == (SystemState.IDLE, True)


async def test_a_posted_reading_is_what_the_mock_goes_on_with(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    supervisor.submit_readings([Reading("battery_level", 0.4)])
    await clock.advance(5)
    assert supervisor.core.signal("battery_level").value == 0.4
    assert supervisor.core.system_state().errors == ("BATTERY_LOW",)


async def test_a_named_source_of_estop_is_kept_apart_from_the_mock_and_from_others(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    supervisor.submit_readings([Reading("estop", value=True)], source="panel")
    supervisor.submit_readings([Reading("estop", value=False)], source="remote")
    supervisor.submit_readings([Reading("estop", value=False)])
    await clock.advance(1)
    assert supervisor.core.system_state().errors == ("ESTOP",)
    supervisor.submit_readings([Reading("estop", value=False)], source="panel")
    await clock.advance(1)
    assert supervisor.core.system_state().errors == ()


async def test_changing_reasons_make_no_more_frames_and_errors_do(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    supervisor.submit_readings([Reading("temperature", 60.0)])
    recorded = Recorded(supervisor)
    with supervisor.frames.watch(recorded):
        for number in range(80):
            supervisor.submit_readings([Reading("temperature", 60.0 + number)])
            await clock.advance(0.0125)
    assert len(recorded.frames) == 20
    assert [frame.full for frame in recorded.frames].count(True) == 1


async def test_ended_changes_are_counted_by_how_they_ended(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    supervisor.submit(ModeRequest(ACTUATION, PERFORMANCE))
    supervisor.submit(ModeRequest(ACTUATION, "MODERATE"))
    await clock.advance(3)
    assert supervisor.ended_changes == {"superseded": 1, "succeeded": 1}


async def test_a_refused_reading_leaves_the_mock_as_it_was(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    with pytest.raises(InvalidValueError):
        supervisor.submit_readings([Reading("battery_level", 0.4), Reading("temperature", "hot")])
    await clock.advance(1)
    assert supervisor.core.signal("battery_level").value == 1.0


async def test_an_older_value_of_the_mock_never_follows_a_posted_one(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    """The mock is due, and has not had its turn, when the reading arrives."""
    await clock.advance(0.095)
    clock.stall(0.01)
    supervisor.submit_readings([Reading("estop", value=True)])
    values = [
        event.data["values"]
        for event in supervisor.events.oldest_first()
        if event.kind == "signal.read"
    ]
    await clock.advance(0)
    assert values[-1] == {"estop": True}
    assert supervisor.core.signal("estop").value is True


async def test_whoever_waits_for_a_change_is_told_its_end(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    change = supervisor.submit(ModeRequest(ACTUATION, PERFORMANCE)).change
    assert change is not None
    waiting = asyncio.ensure_future(supervisor.change_ended(change, 5))
    await clock.advance(2)
    assert waiting.done()
    assert (await waiting).status is ChangeStatus.SUCCEEDED


async def test_whoever_waits_too_short_gets_the_change_as_it_is(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    change = supervisor.submit(ModeRequest(ACTUATION, PERFORMANCE)).change
    assert change is not None
    waiting = asyncio.ensure_future(supervisor.change_ended(change, 0.1))
    await clock.advance(0.2)
    assert (await waiting).status is ChangeStatus.RUNNING


async def test_when_the_service_ends_nobody_waits_any_longer(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    change = supervisor.submit(ModeRequest(ACTUATION, PERFORMANCE)).change
    assert change is not None
    waiting = asyncio.ensure_future(supervisor.change_ended(change, 60))
    await clock.advance(0.1)
    supervisor.stop_waiting()
    assert (await waiting).status is ChangeStatus.RUNNING
    assert (await supervisor.change_ended(change, 60)).status is ChangeStatus.RUNNING


async def test_waiting_for_an_unknown_change_is_an_error(supervisor: Supervisor) -> None:
    with pytest.raises(UnknownChangeError):
        await supervisor.change_ended(ChangeId("c9"), 1)


async def test_what_was_due_before_a_refused_request_is_still_told(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    supervisor.submit_readings([Reading("estop", value=True)])
    supervisor.submit_readings([Reading("estop", value=False)])
    clock.stall(0.3)
    with pytest.raises(UnknownPartError):
        supervisor.submit(ModeRequest(PartName("nobody"), "FAST"))
    kinds = [event.kind for event in supervisor.events.oldest_first()]
    assert "error.cleared" in kinds[-3:]


async def test_a_late_tick_is_skipped_counted_and_not_made_up_for(
    clock: ManualClock, supervisor: Supervisor, caplog: pytest.LogCaptureFixture
) -> None:
    periods: list[float] = []
    supervisor.on_tick.append(periods.append)
    before = supervisor.snapshot_seq
    clock.stall(0.32)
    with caplog.at_level(logging.WARNING):
        await clock.advance(0)
    assert supervisor.late_ticks == 5
    assert supervisor.snapshot_seq == before + 1
    await clock.advance(0.03)
    assert periods == pytest.approx([0.32, 0.03])


class Backend:
    """A robot that does what a test says."""

    simulation: SimulatedRobot | None = None

    def __init__(self, behave: Callable[[Callable[[BackendMessage], None]], None]) -> None:
        self._behave = behave
        self.sent: list[NodeCommand | Drive] = []

    def send(self, command: NodeCommand | Drive) -> None:
        self.sent.append(command)

    async def run(self, deliver: Callable[[BackendMessage], None]) -> None:
        self._behave(deliver)
        await asyncio.Event().wait()


def _supervisor_of(backend: Backend) -> Supervisor:
    clock = ManualClock()
    model = actuation_model()
    onboard = make_onboard(model, clock.now())
    return Supervisor(LoadedModel(model, (), ""), onboard, clock, backend)


async def test_a_task_that_fails_ends_the_supervisor_and_is_named() -> None:
    def fail(_: Callable[[BackendMessage], None]) -> None:
        raise OSError("no such bus")

    with pytest.raises(ExceptionGroup) as raised:
        await _supervisor_of(Backend(fail)).run()
    (error,) = raised.value.exceptions
    assert isinstance(error, TaskFailedError)
    assert (error.name, str(error.__cause__)) == ("robot", "no such bus")


async def test_a_report_that_is_refused_does_not_end_its_adapter(
    caplog: pytest.LogCaptureFixture,
) -> None:
    def report_nobody(deliver: Callable[[BackendMessage], None]) -> None:
        deliver(NodeReport(PartName("nobody"), reachable=True))

    supervisor = _supervisor_of(Backend(report_nobody))
    async with running(supervisor):
        assert "refused NodeReport" in caplog.text
        assert supervisor.core.part(BASE).reachable is False


async def test_commands_reach_the_nodes_before_anybody_is_told() -> None:
    def appear(deliver: Callable[[BackendMessage], None]) -> None:
        deliver(BackendStatus(available=True))

    backend = Backend(appear)
    supervisor = _supervisor_of(backend)
    async with running(supervisor):
        supervisor.submit(EmergencyStopRequest(engaged=True, reason="", actor="test"))
        assert backend.sent == []
        assert supervisor.core.emergency_stop().engaged


async def test_a_service_that_ends_holds_the_task_and_stops_the_vehicle() -> None:
    clock = ManualClock()
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        supervisor.submit(TaskRequest(straight(), 0, "stanley", 2.8))
        await clock.advance(3)
        supervisor.stop_driving()

        assert supervisor.core.driving.vehicle.command.speed_mps == 0.0
        assert "service" in supervisor.core.driving.holds


async def test_a_service_that_ends_does_so_also_where_there_is_no_room_for_a_hold() -> None:
    supervisor = make_supervisor()
    async with running(supervisor):
        supervisor.submit(TaskRequest(straight(), 0, "stanley", 2.8))
        for number in range(MAX_HOLDS):
            supervisor.submit(HoldRequest(f"o{number}", "test"))
        supervisor.stop_driving()

        assert supervisor.core.driving.vehicle.command.speed_mps == 0.0
