import asyncio
import logging
import os
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from api.serving.service_manager import ServiceManager, UnknownManagerError
from domain.onboard import Onboard
from service.simulation.simulated import SimulatedBackend
from service.supervisor import Supervisor
from tests.support.live_robot import running
from tests.support.manual_clock import ManualClock

ABSTRACT = f"@pilothouse-test-{os.getpid()}"


class Socket:
    """What a service manager listens on."""

    def __init__(self, address: str) -> None:
        self.address = address
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(address.replace("@", "\0"))
        self._socket.setblocking(False)

    def heard(self) -> list[str]:
        """Return what was told since the last time."""
        told = []
        try:
            while True:
                told.append(self._socket.recv(100).decode())
        except BlockingIOError:
            return told

    def close(self) -> None:
        self._socket.close()


@pytest.fixture(params=["a path", "an abstract name"])
def manager_socket(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Socket]:
    listening = Socket(str(tmp_path / "notify") if request.param == "a path" else ABSTRACT)
    yield listening
    listening.close()


def manager_of(listening: Socket, **more: str) -> ServiceManager:
    return ServiceManager.of({"NOTIFY_SOCKET": listening.address, **more})


async def test_it_is_ready_once_it_ticks_and_not_before(
    manager_socket: Socket, clock: ManualClock, supervisor: Supervisor
) -> None:
    manager_of(manager_socket).watch(supervisor)
    assert manager_socket.heard() == []

    async with running(supervisor):
        await clock.advance(1)

    assert manager_socket.heard() == ["READY=1"]


async def test_the_watchdog_is_fed_twice_in_its_time(
    manager_socket: Socket, clock: ManualClock, supervisor: Supervisor
) -> None:
    manager_of(manager_socket, WATCHDOG_USEC="2000000").watch(supervisor)
    async with running(supervisor):
        await clock.advance(1)
        manager_socket.heard()

        await clock.advance(10)

    assert manager_socket.heard() == ["WATCHDOG=1"] * 10


async def test_a_supervisor_that_no_longer_ticks_feeds_no_watchdog(
    manager_socket: Socket, clock: ManualClock, supervisor: Supervisor
) -> None:
    manager_of(manager_socket, WATCHDOG_USEC="2000000").watch(supervisor)
    async with running(supervisor):
        await clock.advance(3)
    manager_socket.heard()

    # The event loop turns and time passes; only the supervisor is gone.
    await clock.advance(10)

    assert manager_socket.heard() == []


async def test_a_core_that_misses_its_deadlines_feeds_no_watchdog(
    manager_socket: Socket,
    clock: ManualClock,
    supervisor: Supervisor,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    manager_of(manager_socket, WATCHDOG_USEC="2000000").watch(supervisor)
    missed = clock.now()
    monkeypatch.setattr(Onboard, "wake_at", lambda _: missed)
    ticking = asyncio.create_task(supervisor.publisher.run())
    await clock.advance(10)

    assert manager_socket.heard() == ["READY=1"]
    ticking.cancel()
    await asyncio.wait([ticking])


async def test_publishing_that_hangs_feeds_no_watchdog(
    manager_socket: Socket,
    clock: ManualClock,
    supervisor: Supervisor,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    manager_of(manager_socket, WATCHDOG_USEC="2000000").watch(supervisor)
    async with running(supervisor):
        await clock.advance(3)
        manager_socket.heard()
        monkeypatch.setattr(supervisor.publisher, "publish", lambda **_: None)

        await clock.advance(10)

        assert manager_socket.heard().count("WATCHDOG=1") <= 1


async def test_a_silent_robot_is_an_error_and_does_not_end_its_supervision(
    manager_socket: Socket,
    clock: ManualClock,
    supervisor: Supervisor,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(SimulatedBackend, "run", lambda *_: asyncio.Event().wait())
    manager_of(manager_socket, WATCHDOG_USEC="2000000").watch(supervisor)
    async with running(supervisor):
        await clock.advance(10)

        assert "STALE_DATA" in supervisor.core.system_state().errors
    assert manager_socket.heard() == ["READY=1", *["WATCHDOG=1"] * 10]


async def test_the_watchdog_of_another_process_is_not_fed(
    manager_socket: Socket, clock: ManualClock, supervisor: Supervisor
) -> None:
    other = str(os.getppid())
    manager_of(manager_socket, WATCHDOG_USEC="2000000", WATCHDOG_PID=other).watch(supervisor)
    async with running(supervisor):
        await clock.advance(10)

    assert manager_socket.heard() == ["READY=1"]


async def test_the_watchdog_of_this_process_is_fed(
    manager_socket: Socket, clock: ManualClock, supervisor: Supervisor
) -> None:
    own = str(os.getpid())
    manager_of(manager_socket, WATCHDOG_USEC="2000000", WATCHDOG_PID=own).watch(supervisor)
    async with running(supervisor):
        await clock.advance(3)

    assert "WATCHDOG=1" in manager_socket.heard()


def test_it_tells_that_it_stops(manager_socket: Socket) -> None:
    manager_of(manager_socket).say_stopping()

    assert manager_socket.heard() == ["STOPPING=1"]


def test_without_a_manager_nobody_is_told_and_no_tick_is_watched(supervisor: Supervisor) -> None:
    watched = list(supervisor.publisher.on_tick)
    nobody = ServiceManager.of({"WATCHDOG_USEC": "2000000"})
    nobody.watch(supervisor)
    nobody.say_stopping()

    assert supervisor.publisher.on_tick == watched


async def test_a_manager_that_is_gone_is_complained_of_and_does_not_end_the_tick(
    tmp_path: Path, clock: ManualClock, supervisor: Supervisor, caplog: pytest.LogCaptureFixture
) -> None:
    ServiceManager.of({"NOTIFY_SOCKET": str(tmp_path / "gone")}).watch(supervisor)

    with caplog.at_level(logging.WARNING):
        async with running(supervisor):
            await clock.advance(1)
            assert supervisor.publisher.last_tick_at == clock.now()

    assert "cannot send READY=1 to the service manager" in caplog.text


@pytest.mark.parametrize("address", ["vsock:2:1234", "notify"])
def test_an_address_that_is_no_socket_of_this_machine_is_refused(address: str) -> None:
    with pytest.raises(UnknownManagerError, match=f"NOTIFY_SOCKET is '{address}'"):
        ServiceManager.of({"NOTIFY_SOCKET": address})


@pytest.mark.parametrize("text", ["", "0", "-1", "2s", "²"])
def test_a_time_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(UnknownManagerError, match="WATCHDOG_USEC is"):
        ServiceManager.of({"NOTIFY_SOCKET": "/run/notify", "WATCHDOG_USEC": text})
