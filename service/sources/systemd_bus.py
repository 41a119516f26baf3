"""The bus of systemd; the only module that imports sdbus."""

from sdbus import (
    DbusInterfaceCommon,
    SdBus,
    SdBusLibraryError,
    dbus_method,
    dbus_property,
    sd_bus_open_system,
    sd_bus_open_user,
)

from service.sources.source import SourceError

_SYSTEMD = "org.freedesktop.systemd1"
_MANAGER_PATH = "/org/freedesktop/systemd1"


class _Manager(DbusInterfaceCommon, interface_name="org.freedesktop.systemd1.Manager"):
    @dbus_method(input_signature="s", result_signature="o", method_name="LoadUnit")
    def load_unit(self, name: str) -> str:
        raise NotImplementedError


class _Unit(DbusInterfaceCommon, interface_name="org.freedesktop.systemd1.Unit"):
    @dbus_property(property_signature="s", property_name="LoadState")
    def load_state(self) -> str:
        raise NotImplementedError

    @dbus_property(property_signature="s", property_name="ActiveState")
    def active_state(self) -> str:
        raise NotImplementedError


class _Service(DbusInterfaceCommon, interface_name="org.freedesktop.systemd1.Service"):
    @dbus_property(property_signature="u", property_name="NRestarts")
    def restarts(self) -> int:
        raise NotImplementedError


class ServiceManager:
    """A connection to a service manager; used by one thread."""

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
        self._manager = _Manager(_SYSTEMD, _MANAGER_PATH, self._bus)

    def states(self, unit: str) -> tuple[str, str]:
        """Return load state and active state of a unit."""
        seen = _Unit(_SYSTEMD, self._manager.load_unit(unit), self._bus)
        return seen.load_state, seen.active_state

    def restarts(self, unit: str) -> int:
        """Return how often systemd restarted a service."""
        return _Service(_SYSTEMD, self._manager.load_unit(unit), self._bus).restarts

    def close(self) -> None:
        """Disconnect."""
        self._bus.close()
