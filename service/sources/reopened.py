"""A device that is opened when it is first needed, and again after a failure."""

from collections.abc import Callable
from contextlib import suppress
from typing import Generic, Protocol, TypeVar


class Closable(Protocol):
    """An open device."""

    def close(self) -> None:
        """Close it."""
        ...


DeviceT = TypeVar("DeviceT", bound=Closable)
Result = TypeVar("Result")


class Reopened(Generic[DeviceT]):
    """Keeps a device open between calls; one that fails is closed, since it may come back anew."""

    def __init__(self, open_it: Callable[[], DeviceT]) -> None:
        self._open = open_it
        self._device: DeviceT | None = None

    def use(self, call: Callable[[DeviceT], Result]) -> Result:
        """Return what a call with the open device returns.

        Raises:
            Exception: What opening it or the call raises.
        """
        if self._device is None:
            self._device = self._open()
        try:
            return call(self._device)
        except Exception:
            # What is broken may not close either; why it broke is what is to be told.
            with suppress(Exception):
                self.close()
            raise

    def close(self) -> None:
        """Close the device, if it is open."""
        device, self._device = self._device, None
        if device is not None:
            device.close()
