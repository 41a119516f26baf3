"""The bus of systemd; the only module that imports sdbus."""

import asyncio
from collections.abc import Awaitable
from typing import TypeVar

from sdbus import (
    DbusInterfaceCommonAsync,
    SdBus,
    SdBusLibraryError,
    dbus_method_async,
    dbus_property_async,
    sd_bus_open_system,
    sd_bus_open_user,
)

from service.sources.source import SourceError

_SYSTEMD = "org.freedesktop.systemd1"
_MANAGER_PATH = "/org/freedesktop/systemd1"
_TIMEOUT_S = 0.9

Result = TypeVar("Result")


class Manager(DbusInterfaceCommonAsync, interface_name="org.freedesktop.systemd1.Manager"):
    """The service manager."""

    @dbus_method_async(input_signature="s", result_signature="o", method_name="LoadUnit")
    async def load_unit(self, name: str) -> str:
        """Return the path of a unit, which need not exist."""
        raise NotImplementedError


class Unit(DbusInterfaceCommonAsync, interface_name="org.freedesktop.systemd1.Unit"):
    """A unit."""

    @dbus_property_async(property_signature="s", property_name="LoadState")
    def load_state(self) -> str:
        """`loaded`, `not-found` and others."""
        raise NotImplementedError

    @dbus_property_async(property_signature="s", property_name="ActiveState")
    def active_state(self) -> str:
        """`active`, `failed` and others."""
        raise NotImplementedError


class Service(DbusInterfaceCommonAsync, interface_name="org.freedesktop.systemd1.Service"):
    """A unit that is a service."""

    @dbus_property_async(property_signature="u", property_name="NRestarts")
    def restarts(self) -> int:
        """How often it was restarted by itself."""
        raise NotImplementedError


class ServiceManager:
    """A connection to a service manager; used by one thread.

    The calls of sdbus that block keep every other thread of Python from running, up to 25 s. So
    its asynchronous ones are used, on a loop of our own.
    """

    def __init__(self, manager: str) -> None:
        """Connect.

        Args:
            manager: `system` or `user`.

        Raises:
            SourceError: There is no such bus.
        """
        try:
            bus = sd_bus_open_system() if manager == "system" else sd_bus_open_user()
        except SdBusLibraryError as error:
            raise SourceError(f"there is no {manager} bus") from error
        self._bus: SdBus = bus
        self._manager = Manager.new_proxy(_SYSTEMD, _MANAGER_PATH, bus)
        self._loop = asyncio.SelectorEventLoop()

    def states(self, unit: str) -> tuple[str, str]:
        """Return load state and active state of a unit.

        Raises:
            SourceError: There is no answer.
        """
        return self._wait(self._states(unit))

    def restarts(self, unit: str) -> int:
        """Return how often systemd restarted a service.

        Raises:
            SourceError: There is no answer.
        """
        return self._wait(self._restarts(unit))

    def close(self) -> None:
        """Disconnect."""
        self._loop.close()
        self._bus.close()

    async def _states(self, unit: str) -> tuple[str, str]:
        seen = Unit.new_proxy(_SYSTEMD, await self._manager.load_unit(unit), self._bus)
        return await seen.load_state, await seen.active_state

    async def _restarts(self, unit: str) -> int:
        seen = Service.new_proxy(_SYSTEMD, await self._manager.load_unit(unit), self._bus)
        return await seen.restarts

    def _wait(self, answer: Awaitable[Result]) -> Result:
        try:
            return self._loop.run_until_complete(asyncio.wait_for(answer, _TIMEOUT_S))
        except TimeoutError as error:
            raise SourceError("systemd does not answer") from error
