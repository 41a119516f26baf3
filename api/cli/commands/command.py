"""What a command is, and the options that several of them have."""

import argparse
import math
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from api.client.service_client import Outcome, ServiceClient

DEFAULT_URL = "http://127.0.0.1:8000"
_MAX_WAIT_S = 3600.0

CHANGE_CODES = """\
exit code: 0 succeeded; 1 refused or failed;
           2 unknown: not ended in time, or no answer
"""


@dataclass(frozen=True, slots=True)
class Command:
    """One command of `pilothouse`."""

    name: str
    about: str
    """A few words, for the list of commands."""
    text: str
    """What `--help` says."""
    add_options: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace], int]
    """Does it, and returns the exit code."""


def default_url() -> str:
    """Return where the service runs if nobody says so."""
    return os.environ.get("PILOTHOUSE_URL") or DEFAULT_URL


def add_url(parser: argparse.ArgumentParser) -> None:
    """Add `--url`."""
    parser.add_argument(
        "--url",
        default=default_url(),
        help=f"where the service runs; default: PILOTHOUSE_URL, else {DEFAULT_URL}; its token is"
        " that of PILOTHOUSE_TOKEN, or in the file of PILOTHOUSE_TOKEN_FILE",
    )


def add_change_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of a command that asks for a change and follows it."""
    add_url(parser)
    parser.add_argument(
        "--wait",
        default=60.0,
        type=_wait_s,
        metavar="S",
        help="seconds to wait for the end; %(default)g",
    )
    parser.add_argument("--dry-run", action="store_true", help="say the steps, change nothing")


def ask_for_change(options: argparse.Namespace, what: str, request: dict[str, str]) -> int:
    """Ask for a change, follow it, and return the exit code.

    Args:
        options: Those of `add_change_options`, and `part`.
        what: `mode` or `state`.
        request: Body of the request.
    """
    from api.client.service_client import change, show_plan

    def run(client: "ServiceClient") -> "Outcome":
        if options.dry_run:
            return show_plan(client, options.part, what, request, print)
        return change(client, options.part, what, request, options.wait, print)

    return with_service(options.url, run)


def with_service(url: str, run: Callable[["ServiceClient"], "Outcome"]) -> int:
    """Run something with a client, and say why if it is refused or nobody answers.

    Args:
        url: Where the service runs.
        run: What to do.
    """
    from api.client.service_client import service_at

    def ask() -> "Outcome":
        with service_at(url) as client:
            return run(client)

    return answered(ask)


def answered(ask: Callable[[], int]) -> int:
    """Return the exit code of something that asks a service; say why if it comes to nothing.

    Args:
        ask: What to do; returns the exit code.
    """
    from api.client.service_client import NoAnswerError, Outcome, ServiceProblemError, refusal_lines

    try:
        return ask()
    except ServiceProblemError as error:
        for line in refusal_lines(error.problem):
            print(line, file=sys.stderr)
        return Outcome.FAILED
    except NoAnswerError as error:
        complain(str(error))
        return Outcome.UNKNOWN


def complain(message: str) -> None:
    """Say what went wrong."""
    print(f"pilothouse: {message}", file=sys.stderr)


def _wait_s(text: str) -> float:
    number = float(text)
    if not (math.isfinite(number) and 0 <= number <= _MAX_WAIT_S):
        raise argparse.ArgumentTypeError(f"{text} is not within 0 to {_MAX_WAIT_S:g} seconds")
    return number
