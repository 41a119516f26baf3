"""The signals that end the service: the first stops the vehicle, a later one ends the process."""

import asyncio
import logging
import os
import signal
from collections.abc import Callable

INTERRUPTED = 130

log = logging.getLogger(__name__)

# All that would end a process that does not handle them: SIGHUP comes when a terminal or an ssh
# session closes, SIGXCPU from `ulimit -t`, SIGUSR1 from a tool that takes this for another program.
_ENDING = [
    "SIGINT",
    "SIGTERM",
    "SIGHUP",
    "SIGQUIT",
    "SIGUSR1",
    "SIGUSR2",
    "SIGALRM",
    "SIGVTALRM",
    "SIGPROF",
    "SIGXCPU",
    "SIGIO",
    "SIGPWR",
    "SIGSTKFLT",
]
_ALWAYS = frozenset({"SIGINT", "SIGTERM"})
"""Handled even if they are ignored at the start, as SIGINT is in the background of a script."""
_URGENT = frozenset({"SIGINT", "SIGTERM", "SIGQUIT"})
"""Asked for by a person or a service manager, who may not want to wait."""
_ONE_OCCASION_S = 0.1
"""`make run` and other wrappers pass on a Ctrl-C that the terminal has sent to us already."""


class StopSignals:
    """Calls `stop` at the first signal; a second one that is urgent ends the process at once."""

    def __init__(self, stop: Callable[[], None]) -> None:
        """Prepare.

        Args:
            stop: Called on the event loop's thread; once it has returned, the process may end.
        """
        self._stop = stop
        self._since: float | None = None

    def install(self) -> None:
        """Handle the signals in the running event loop.

        A signal that is ignored at the start stays ignored, so that `nohup` works.
        """
        loop = asyncio.get_running_loop()
        for name in _ENDING:
            number = getattr(signal, name, None)
            if number is None:
                continue
            if name in _ALWAYS or signal.getsignal(number) is not signal.SIG_IGN:
                loop.add_signal_handler(number, self.take, name, loop.time)

    def take(self, name: str, read_clock: Callable[[], float]) -> None:
        """Take a signal.

        Args:
            name: Its name, such as `SIGHUP`.
            read_clock: Returns monotonic time, s.
        """
        if self._since is None:
            self._since = read_clock()
            log.debug("%s: the vehicle is stopped, and the service ends", name)
            self._stop()
        elif name in _URGENT and read_clock() - self._since >= _ONE_OCCASION_S:
            os._exit(INTERRUPTED)
