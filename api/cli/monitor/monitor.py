"""`pilothouse monitor`: watch a robot on a terminal, or log its changes."""

import asyncio
import io
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Protocol, TypeAlias

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


class Feed(Protocol):
    """Tells a watch how the robot is."""

    @property
    def watch(self) -> Watch:
        """Return the watch that is told."""
        ...

    async def run(self) -> None:
        """Tell until cancelled, also after an interruption."""
        ...

    async def run_once(self) -> None:
        """Tell until the picture is whole.

        Raises:
            NoAnswerError: Nobody answers, or not in time.
        """
        ...


MakeFeed: TypeAlias = Callable[[Callable[[], None]], Feed]
"""Makes a feed whose watch calls a function at news."""


def monitor(url: str, form: Form, *, once: bool) -> int:
    """Show the robot of a service until q or Ctrl-C, or once; return the exit code.

    Args:
        url: Where the service runs.
        form: `text` for people, `json` for programs.
        once: Write one picture only.

    Raises:
        NoAnswerError: The address or the token is invalid, or with `once` there is no answer.
        ServiceProblemError: The service rejects us.
    """
    address = Address.with_token_of_environment(url)
    show(partial(_ServiceFeed, address), form, once=once)
    return Outcome.SUCCEEDED


def show(make: MakeFeed, form: Form, *, once: bool) -> None:
    """Show what a feed tells until q or Ctrl-C, or once.

    Args:
        make: Makes the feed.
        form: `text` for people, `json` for programs.
        once: Write one picture only.

    Raises:
        NoAnswerError: With `once`, nobody answers.
    """
    console = _console()
    if once:
        asyncio.run(_once(make(_nothing), form, console))
        return
    # Ctrl-C, and a terminal that goes away, are how this ends.
    with suppress(KeyboardInterrupt, asyncio.CancelledError):
        if form == "text" and is_drawn():
            asyncio.run(_draw(make(_nothing), console))
        else:
            asyncio.run(_log(make, form, console))


def is_drawn() -> bool:
    """Tell whether the standard output is a terminal that can be drawn on."""
    return sys.stdout.isatty() and not _console().is_dumb_terminal


def _console() -> Console:
    """Return a console for the standard output, with colours only on a terminal."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        # An encoding without an ellipsis shows a question mark.
        sys.stdout.reconfigure(errors="replace")
    return Console(force_terminal=sys.stdout.isatty(), highlight=False, markup=False, emoji=False)


class _ServiceFeed:
    """Tells what a service tells."""

    def __init__(self, address: Address, news: Callable[[], None]) -> None:
        self.watch = Watch(address.url, news=self._note_news)
        self._news = news
        self._whole = asyncio.Event()
        self._link = Link(address, self.watch)
        self._url = address.url

    async def run(self) -> None:
        await self._link.run()

    async def run_once(self) -> None:
        async def wait() -> None:
            await self._whole.wait()

        try:
            async with asyncio.timeout(_PATIENCE_S):
                await until_first_ends(self._link.serve(), wait())
        except TimeoutError as error:
            message = f"no complete state from {self._url} within {_PATIENCE_S:g} s"
            raise NoAnswerError(message) from error

    def _note_news(self) -> None:
        if self.watch.robot.is_whole:
            self._whole.set()
        self._news()


def _nothing() -> None:
    """Do nothing."""


async def _once(feed: Feed, form: Form, console: Console) -> None:
    await feed.run_once()
    write_picture(feed.watch.view(), form, console)


async def _log(make: MakeFeed, form: Form, console: Console) -> None:
    _end_with_signals()
    log = ChangeLog(form, console)
    feed = make(lambda: log.look(feed.watch.view()))
    await feed.run()


async def _draw(feed: Feed, console: Console) -> None:
    _end_with_signals()
    with alternate_screen(console) as screen:
        if hasattr(signal, "SIGCONT"):
            handler = partial(_come_back, screen)
            asyncio.get_running_loop().add_signal_handler(signal.SIGCONT, handler)
        await until_first_ends(
            feed.run(),
            _redraw(screen, feed.watch, console),
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
