"""The calls to systemd, on a private bus with a service manager of our own."""

import asyncio
import shutil
import subprocess
import threading
from collections.abc import Iterator
from contextlib import closing

import pytest

from service.sources.source import SourceError

pytest.importorskip("sdbus")
pytestmark = pytest.mark.skipif(shutil.which("dbus-daemon") is None, reason="needs dbus-daemon")

from sdbus import (  # noqa: E402  # sdbus is for Linux only
    SdBus,
    dbus_method_async_override,
    dbus_property_async_override,
    sd_bus_open_system,
)

from service.sources import systemd_bus  # noqa: E402
from service.sources.systemd_bus import ServiceManager  # noqa: E402

SYSTEMD = "org.freedesktop.systemd1"
UNIT_PATH = "/org/freedesktop/systemd1/unit/camera_2eservice"


class _FakeManager(systemd_bus.Manager):
    @dbus_method_async_override()
    async def load_unit(self, name: str) -> str:
        await asyncio.sleep(0 if name == "camera.service" else 60)
        return UNIT_PATH


class _FakeUnit(systemd_bus.Unit):
    @dbus_property_async_override()
    def load_state(self) -> str:
        return "loaded"

    @dbus_property_async_override()
    def active_state(self) -> str:
        return "failed"


class _FakeService(systemd_bus.Service):
    @dbus_property_async_override()
    def restarts(self) -> int:
        return 4


class _Exported(_FakeUnit, _FakeService):
    """A unit that is a service."""


@pytest.fixture
def bus() -> Iterator[str]:
    """Give the address of a private bus."""
    daemon = subprocess.Popen(
        ("dbus-daemon", "--session", "--nofork", "--print-address"),
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert daemon.stdout is not None
        yield daemon.stdout.readline().strip()
    finally:
        daemon.terminate()
        daemon.communicate(timeout=10)


@pytest.fixture
def _systemd(bus: str, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Serve units on that bus, in a thread of their own, and let it be the bus of the system."""
    monkeypatch.setenv("DBUS_SYSTEM_BUS_ADDRESS", bus)
    ready, loop = threading.Event(), asyncio.new_event_loop()

    async def serve() -> tuple[object, SdBus]:
        connection = sd_bus_open_system()
        objects = _FakeManager(), _Exported()
        objects[0].export_to_dbus("/org/freedesktop/systemd1", connection)
        objects[1].export_to_dbus(UNIT_PATH, connection)
        await connection.request_name_async(SYSTEMD, 0)
        ready.set()
        return objects, connection

    def run() -> None:
        asyncio.set_event_loop(loop)
        kept = loop.run_until_complete(serve())
        loop.run_forever()
        for task in asyncio.all_tasks(loop):
            task.cancel()
        loop.run_until_complete(asyncio.sleep(0.01))
        kept[1].close()
        loop.close()

    thread = threading.Thread(target=run)
    thread.start()
    assert ready.wait(10)
    yield
    loop.call_soon_threadsafe(loop.stop)
    thread.join(10)


@pytest.mark.usefixtures("_systemd")
async def test_a_manager_that_does_not_answer_keeps_no_other_thread_waiting() -> None:
    with closing(ServiceManager("system")) as manager:
        asked = asyncio.create_task(asyncio.to_thread(manager.states, "slow.service"))
        turns = 0
        while not asked.done():
            turns += 1
            await asyncio.sleep(0.01)
        with pytest.raises(SourceError, match="systemd does not answer"):
            await asked
        again = await asyncio.to_thread(manager.states, "camera.service")
        assert again == ("loaded", "failed")
    assert turns > 5


@pytest.mark.usefixtures("_systemd")
def test_a_unit_is_asked_for_its_state_and_its_restarts() -> None:
    with closing(ServiceManager("system")) as manager:
        assert manager.states("camera.service") == ("loaded", "failed")
        assert manager.restarts("camera.service") == 4


def test_without_a_bus_there_is_nobody_to_ask(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/nowhere")
    with pytest.raises(SourceError, match="there is no system bus"):
        ServiceManager("system")
