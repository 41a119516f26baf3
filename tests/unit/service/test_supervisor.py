"""The supervisor in virtual time: what arrives is decided at once, the tick only publishes."""

import asyncio
from collections.abc import Callable
from itertools import takewhile
from pathlib import Path
from typing import NoReturn

import pytest

from domain.actor import Actor
from domain.commands import ActAlone, Drive, LinkCommand, NodeCommand, TellStops
from domain.computers import ComputerName
from domain.health.signals import default_signals
from domain.inputs import (
    BackendStatus,
    EmergencyStopRequest,
    HoldRequest,
    Input,
    ReleaseRequest,
    TaskRequest,
)
from domain.kept import KeptEmergencyStop
from domain.supervision import SupervisionSettings
from domain.tasks.holds import MAX_HOLDS
from domain.timebase import seconds
from service.files.model_file import LoadedModel
from service.keeper import NO_STORES, Stores
from service.ports import BackendMessage
from service.running import TaskFailedError
from service.storage.journal import ANNOUNCED, Boot
from service.storage.memory import MemoryJournal, MemoryStore
from service.storage.trends.trends import Trends
from service.supervisor import Supervisor
from tests.support.live_robot import make_live_robot, make_onboard, make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.models import actuation_model
from tests.support.paths import straight
from tests.support.waiting import until


class Backend:
    """A robot that does what a test says."""

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


async def test_commands_reach_the_nodes_before_anybody_is_told() -> None:
    def appear(deliver: Callable[[BackendMessage], None]) -> None:
        deliver(BackendStatus(available=True))

    backend = Backend(appear)
    supervisor = _supervisor_of(backend)
    async with running(supervisor):
        supervisor.submit(EmergencyStopRequest(engaged=True, reason="", actor=Actor("test")))
        assert backend.sent == []
        assert supervisor.core.emergency_stop().engaged


class Link:
    """Other computers, which note what they are told."""

    def __init__(self) -> None:
        self.sent: list[LinkCommand] = []

    def send(self, command: LinkCommand) -> None:
        self.sent.append(command)

    def note(self, _: Input) -> None:
        """Learn nothing."""

    def connection(self, _: ComputerName) -> NoReturn:
        raise NotImplementedError

    async def run(self, _: Callable[[BackendMessage], None]) -> None:
        self.sent.append(ActAlone(autonomous=False))
        await asyncio.Event().wait()


def _told(link: Link) -> list[list[str]]:
    return [
        [stop.by for stop in command.stops]
        for command in takewhile(lambda command: isinstance(command, TellStops), link.sent)
        if isinstance(command, TellStops)
    ]


@pytest.mark.parametrize("is_kept", [True, False])
async def test_other_computers_know_of_a_stop_before_they_hear_anything_else(
    is_kept: bool,
) -> None:
    clock, model = ManualClock(), actuation_model()
    peers = SupervisionSettings(peers=(ComputerName("arm"),))
    store = MemoryStore(kept={(KeptEmergencyStop, ""): KeptEmergencyStop(True, "ada", "", 0)})
    boot = Boot("e1", "1", clock.now(), clock.wall_time(clock.now()), "", "")
    supervisor = Supervisor(
        LoadedModel(model, (), ""),
        make_onboard(model, clock.now(), peers),
        clock,
        Backend(lambda _: None),
        stores=Stores(MemoryJournal(boot, clock, store)) if is_kept else NO_STORES,
    )
    supervisor.link = link = Link()
    async with running(supervisor):
        supervisor.submit(EmergencyStopRequest(engaged=True, reason="", actor=Actor("bert")))

    assert _told(link)[0] == (["ada"] if is_kept else [])
    (stop,) = supervisor.core.stops_to_tell().stops
    assert stop.id.startswith(f"{supervisor.epoch}-"), "no other run has such a stop"


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


async def test_the_history_of_signals_is_written_while_the_service_runs(tmp_path: Path) -> None:
    clock = ManualClock()
    signals, path = default_signals(), str(tmp_path / "trends.db")
    trends = Trends(signals, path)
    supervisor, _ = make_live_robot(clock, trends=trends)
    async with running(supervisor):
        await clock.advance(30)
        await until(lambda: trends.status.bytes > 0)

    # As after `kill -9`: only what was written is there.
    later = Trends(signals, path)
    found = await later.history("temperature", clock.now() - seconds(60.0), clock.now(), 100)
    assert len(found.points) > 10
    await later.close()
    await trends.close()


def kept_robot(clock: ManualClock, store: MemoryStore) -> Supervisor:
    boot = Boot("first", "1", clock.now(), clock.wall_time(clock.now()), "", "")
    return make_supervisor(clock, journal=MemoryJournal(boot, clock, store))


async def test_a_release_of_what_is_released_need_not_wait_for_a_disk() -> None:
    store = MemoryStore()
    supervisor = kept_robot(ManualClock(), store)

    await supervisor.request(ReleaseRequest("operator"))
    await supervisor.request(EmergencyStopRequest(engaged=False, reason=""))
    assert ANNOUNCED not in store.own

    await supervisor.request(HoldRequest("operator", "lunch"))
    await supervisor.request(ReleaseRequest("operator"), volatile=True)
    assert ANNOUNCED not in store.own

    await supervisor.request(HoldRequest("operator", "lunch"))
    await supervisor.request(ReleaseRequest("operator"))
    assert store.own[ANNOUNCED] == [[1, "ReleaseRequest"]]
