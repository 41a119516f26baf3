"""Notifies the service manager (systemd) of start, watchdog and stop.

The protocol is that of `sd_notify`: a datagram of text to the socket that `NOTIFY_SOCKET` names.
"""

import logging
import os
import socket
from collections.abc import Callable, Mapping
from functools import partial
from typing import Self

from service.supervisor import Supervisor

log = logging.getLogger(__name__)

SOCKET_VARIABLE = "NOTIFY_SOCKET"
WATCHDOG_VARIABLE = "WATCHDOG_USEC"
WATCHED_VARIABLE = "WATCHDOG_PID"

_USEC_PER_S = 1e6


class UnknownManagerError(Exception):
    """The environment variables of the service manager are invalid; the message says which."""


class ServiceManager:
    """The service manager; it is notified that the service is ready, ticks, and stops.

    It is notified from the tick, and the watchdog is fed only if nothing of the supervision hangs:
    not the event loop, not the core, and not the publishing of frames.

    Args:
        address: Path of its socket, or `@` and an abstract name; None: there is no manager.
        watchdog_s: Timeout of its watchdog, s; None: it has none.
    """

    def __init__(self, address: str | None = None, watchdog_s: float | None = None) -> None:
        self._address = address
        # Half of it, so that one late tick or lost message does not end the service.
        self._feed_every_s = None if watchdog_s is None else watchdog_s / 2
        self._silent_for_s = 0.0
        self._ready = False

    @classmethod
    def of(cls, environ: Mapping[str, str]) -> Self:
        """Return the manager that the environment of this process names, if any.

        Args:
            environ: As `os.environ`.

        Raises:
            UnknownManagerError: A variable is invalid.
        """
        address = environ.get(SOCKET_VARIABLE)
        if not address:
            return cls()
        if address[0] not in "/@":
            raise UnknownManagerError(
                f"{SOCKET_VARIABLE} is {address!r}; it must be a path, or @ and a name"
            )
        return cls(address, _watchdog_s(environ))

    def watch(self, supervisor: Supervisor) -> None:
        """Notify the manager of ticks from now on; the first means that the service is ready."""
        if self._address is not None:
            supervisor.publisher.on_tick.append(partial(self._ticked, supervisor.hanging))

    def say_stopping(self) -> None:
        """Notify the manager that the service stops, so that its end is not taken for a failure."""
        self._tell("STOPPING=1")

    def _ticked(self, hanging: Callable[[], str | None], period_s: float) -> None:
        self._silent_for_s += period_s
        if not self._ready:
            self._ready = True
            self._tell("READY=1")
        elif self._feed_every_s is not None and self._silent_for_s >= self._feed_every_s:
            self._feed(hanging())

    def _feed(self, hanging: str | None) -> None:
        if hanging is None:
            self._silent_for_s = 0.0
            self._tell("WATCHDOG=1")
        else:
            log.error("the watchdog is not fed: %s", hanging)

    def _tell(self, message: str) -> None:
        if self._address is None:
            return
        address = self._address
        if address.startswith("@"):
            address = "\0" + address[1:]
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
                # The tick must not block.
                sender.setblocking(False)
                sender.sendto(message.encode("ascii"), address)
        except OSError as error:
            log.warning("cannot send %s to the service manager: %s", message, error)


def _watchdog_s(environ: Mapping[str, str]) -> float | None:
    """Return the timeout of the watchdog, s; None: there is none."""
    text = environ.get(WATCHDOG_VARIABLE)
    if text is None or environ.get(WATCHED_VARIABLE, str(os.getpid())) != str(os.getpid()):
        return None
    if not (text.isascii() and text.isdecimal() and int(text) > 0):
        raise UnknownManagerError(
            f"{WATCHDOG_VARIABLE} is {text!r}; it must be a whole number of microseconds above 0"
        )
    return int(text) / _USEC_PER_S
