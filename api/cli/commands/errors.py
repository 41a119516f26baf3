"""`pilothouse errors`: which errors the robot has; acknowledges and shelves them."""

import argparse
import json
from collections.abc import Callable
from typing import TYPE_CHECKING

from api.cli.commands.command import Command, add_format, add_shelving_time, add_url, with_service
from api.cli.error_lines import error_lines, is_on
from api.cli.error_requests import acknowledge, open_errors, shelve, unshelve
from api.client.outcomes import Outcome
from api.terminal_text import say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_ABOUT = "list the errors of the robot; acknowledge and shelve them"
_TEXT = """\
List the errors that are not normal or are shelved: roots first, what follows
from each below it, what is not announced last. A name is that of an error of
the robot itself, such as BATTERY_LOW, or has its part in front: lidar.SILENT.

Shelving and suppressing silence an error; its state, its bit and its reactions
stay as they are.

exit code: 0 no error is on, or all that was asked for is done;
           1 an error is on, or something was rejected; 2 no answer
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--part", help="only errors of this system or node")
    parser.add_argument(
        "--ack", metavar="NAME", action="append", default=[], help="acknowledge an error"
    )
    parser.add_argument(
        "--shelve", metavar="NAME", action="append", default=[], help="shelve an error"
    )
    add_shelving_time(parser)
    parser.add_argument("--reason", default="", help="why it is shelved; needed")
    parser.add_argument(
        "--unshelve", metavar="NAME", action="append", default=[], help="announce an error again"
    )
    add_format(parser)
    add_url(parser)


def _run(options: argparse.Namespace) -> int:
    def ask(client: "ServiceClient") -> Outcome:
        if not (options.ack or options.shelve or options.unshelve):
            return list_errors(client, options.part, options.format, say)
        for name in options.ack:
            acknowledge(client, name)
        for name in options.shelve:
            shelve(client, name, options.for_s, options.reason)
        for name in options.unshelve:
            unshelve(client, name)
        return Outcome.SUCCEEDED

    return with_service(options.url, ask)


ERRORS = Command("errors", _ABOUT, _TEXT, _add_options, _run)


def list_errors(
    client: "ServiceClient", part: str | None, how: str, say: Callable[[str], None]
) -> Outcome:
    """List the errors that an operator may want to see; return whether none is on.

    Args:
        client: The service.
        part: Only of this system or node; None: all.
        how: `text` or `json`.
        say: Prints a line for the user.

    Raises:
        ServiceProblemError: There is no such part.
        NoAnswerError: The service did not answer.
    """
    found = open_errors(client, part)
    if how == "json":
        say(json.dumps(found))
    else:
        for line in error_lines(found["items"]) if found["items"] else ("no errors",):
            say(line)
    return Outcome.FAILED if any(map(is_on, found["items"])) else Outcome.SUCCEEDED
