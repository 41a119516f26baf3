"""`pilothouse monitor`: watch a robot on a terminal, or log its changes."""

import asyncio
import io
import signal
import sys
from contextlib import suppress
from functools import partial

from rich.console import Console

from api.cli.first_ended import until_first_ends
from api.cli.monitor.keyboard import Keyboard, take_single_keys
from api.cli.monitor.output import ChangeLog, Form, write_picture
from api.cli.monitor.picture import picture
from api.cli.monitor.screen import Screen, alternate_screen
from api.cli.monitor.watch import Watch
from api.client.address import Address
from api.client.link import Link
from api.client.outcomes import NoAnswerError, Outcome

REDRAW_S = 0.25
_PATIENCE_S = 10.0


def monitor(url: str, form: Form, *, once: bool) -> int:
    """Show a robot until q or Ctrl-C, or once; return the exit code.

    Args:
        url: Where the service runs.
        form: `text` for people, `json` for programs.
        once: Write one picture only.

    Raises:
        NoAnswerError: The address or the token is invalid, or with `once` there is no answer.
        ServiceProblemError: The service rejects us.
    """
    address = Address.with_token_of_environment(url)
    console = _console()
    if once:
        asyncio.run(_once(address, form, console))
        return Outcome.SUCCEEDED
    is_drawn = form == "text" and sys.stdout.isatty() and not console.is_dumb_terminal
    # Ctrl-C, and a terminal that goes away, are how this ends.
    with suppress(KeyboardInterrupt, asyncio.CancelledError):
        asyncio.run(_draw(address, console) if is_drawn else _log(address, form, console))
    return Outcome.SUCCEEDED


def _console() -> Console:
    """Return a console for the standard output, with colours only on a terminal."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        # An encoding without an ellipsis shows a question mark.
        sys.stdout.reconfigure(errors="replace")
    return Console(force_terminal=sys.stdout.isatty(), highlight=False, markup=False, emoji=False)


async def _once(address: Address, form: Form, console: Console) -> None:
    whole = asyncio.Event()
    watch = Watch(address.url, lambda: whole.set() if watch.robot.is_whole else None)

    async def wait() -> None:
        await whole.wait()

    try:
        async with asyncio.timeout(_PATIENCE_S):
            await until_first_ends(Link(address, watch).serve(), wait())
    except TimeoutError as error:
        message = f"no complete state from {address.url} within {_PATIENCE_S:g} s"
        raise NoAnswerError(message) from error
    write_picture(watch.view(), form, console)


async def _log(address: Address, form: Form, console: Console) -> None:
    _end_with_signals()
    log = ChangeLog(form, console)
    watch = Watch(address.url, lambda: log.look(watch.view()))
    await Link(address, watch).run()


async def _draw(address: Address, console: Console) -> None:
    _end_with_signals()
    watch = Watch(address.url)
    with alternate_screen(console) as screen:
        if hasattr(signal, "SIGCONT"):
            handler = partial(_come_back, screen)
            asyncio.get_running_loop().add_signal_handler(signal.SIGCONT, handler)
        await until_first_ends(
            Link(address, watch).run(),
            _redraw(screen, watch, console),
            Keyboard().until_quit(),
        )


def _come_back(screen: Screen) -> None:
    """Go on after Ctrl-Z and `fg`: the terminal shows something else, and was reset."""
    screen.forget()
    take_single_keys()


async def _redraw(screen: Screen, watch: Watch, console: Console) -> None:
    """Redraw a few times a second, so that a slow serial line keeps up."""
    while True:
        screen.draw(picture(watch.view(), console, console.height))
        await asyncio.sleep(REDRAW_S)


def _end_with_signals() -> None:
    """Let SIGTERM and SIGHUP end this like Ctrl-C, so that the terminal is restored."""
    task = asyncio.current_task()
    for name in ("SIGTERM", "SIGHUP"):
        # Windows has neither SIGHUP nor loops with signal handlers; Ctrl-C ends this there.
        with suppress(AttributeError, NotImplementedError):
            number = getattr(signal, name)
            asyncio.get_running_loop().add_signal_handler(number, lambda: task and task.cancel())
