"""The type of a command, and options that several commands share."""

import argparse
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from api.client.outcomes import NoAnswerError, Outcome, ServiceProblemError, refusal_lines
from api.terminal_text import complain, say, visible

if TYPE_CHECKING:
    # When a command runs, and not for `--help`: it brings httpx.
    from api.client.service_client import ServiceClient

DEFAULT_URL = "http://127.0.0.1:8000"
_UNITS = {"s": 1.0, "min": 60.0, "h": 3_600.0}


@dataclass(frozen=True, slots=True)
class Command:
    """One command of `pilothouse`."""

    name: str
    about: str
    """Short description, for the list of commands."""
    text: str
    """Text of `--help`."""
    add_options: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace], int]
    """Runs the command and returns the exit code."""
    words: str | None = None
    """Option that also gets what is left over of the command line; None: that is an error."""
    is_urgent: bool = False
    """Runs at once, without the check that the installed packages are ours."""


def port(text: str) -> int:
    """Read a port.

    Raises:
        ArgumentTypeError: It is none.
    """
    number = int(text)
    if not 0 <= number <= 65_535:
        raise argparse.ArgumentTypeError(f"invalid port {number}; expected 0 to 65535")
    return number


def span(text: str) -> float:
    """Read a time with its unit, s, min or h; without one it is in seconds.

    Raises:
        ArgumentTypeError: It is no such time.
    """
    number = text.rstrip("smhin")
    try:
        return float(number) * _UNITS[text[len(number) :] or "s"]
    except (ValueError, KeyError):
        message = f"invalid time {text!r}; such as 90s, 10min or 8h"
        raise argparse.ArgumentTypeError(message) from None


def add_shelving_time(parser: argparse.ArgumentParser) -> None:
    """Add `--for`: how long errors are not announced, in s as `for_s`."""
    parser.add_argument(
        "--for",
        dest="for_s",
        metavar="TIME",
        type=span,
        default=600.0,
        help="how long, such as 90s, 10min or 8h; default: 10min",
    )


def default_url() -> str:
    """Return the default URL of the service."""
    return os.environ.get("PILOTHOUSE_URL") or DEFAULT_URL


def add_url(parser: argparse.ArgumentParser, *, is_needed: bool = True) -> None:
    """Add `--url`.

    Args:
        parser: Of the command.
        is_needed: Whether an URL has to follow.
    """
    parser.add_argument(
        "--url",
        nargs=None if is_needed else "?",
        default=default_url(),
        help=f"URL of the service; default: PILOTHOUSE_URL, else {DEFAULT_URL}; the token is read"
        " from PILOTHOUSE_TOKEN, or from the file named by PILOTHOUSE_TOKEN_FILE",
    )


def add_format(parser: argparse.ArgumentParser, json: str = "json: for programs") -> None:
    """Add `--format`.

    Args:
        parser: Of the command.
        json: What is printed as JSON, for the help.
    """
    parser.add_argument(
        "--format", choices=("text", "json"), default="text", help=f"default: %(default)s; {json}"
    )


def say_json(value: object) -> None:
    """Print a JSON document; characters beyond ASCII are escaped, and so harmless."""
    import json

    say(json.dumps(value))


def with_service(url: str, run: Callable[["ServiceClient"], Outcome]) -> int:
    """Run something with a client; report a rejection, or a service that does not answer.

    What was done and is not stored is told as well; it is no failure.

    Args:
        url: Where the service runs.
        run: What to do.
    """
    from api.client.service_client import service_at

    def ask() -> Outcome:
        with service_at(url) as client:
            outcome = run(client)
            if why := client.why_forgotten():
                complain(f"a restart of the service would forget this: {why}")
            return outcome

    return answered(ask)


def answered(ask: Callable[[], int]) -> int:
    """Return the exit code of something that asks a service; say why if it comes to nothing.

    Args:
        ask: What to do; returns the exit code.
    """
    try:
        return ask()
    except ServiceProblemError as error:
        for line in refusal_lines(error.problem):
            print(visible(line), file=sys.stderr)
        return Outcome.FAILED
    except NoAnswerError as error:
        complain(str(error))
        return Outcome.UNKNOWN
