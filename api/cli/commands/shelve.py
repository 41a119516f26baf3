"""`pilothouse shelve`: do not announce an error for a time."""

import argparse
from typing import TYPE_CHECKING

from api.cli.commands.command import (
    Command,
    add_format,
    add_shelving_time,
    add_url,
    say_json,
    with_service,
)
from api.cli.completers import open_error_names
from api.cli.error_requests import shelve, unshelve
from api.client.outcomes import Outcome
from api.terminal_text import say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_ABOUT = "do not announce errors for a time"
_TEXT = """\
Shelve errors: they are not announced for a time. Their states, bits and
reactions stay as they are. --end announces them again.

  pilothouse shelve lidar.SILENT --for 10min --reason "it is being cleaned"
  pilothouse shelve --end lidar.SILENT

exit code: 0 done; 1 rejected, or there is no such error; 2 no answer
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    names = parser.add_argument(
        "names", metavar="NAME", nargs="+", help="such as ESTOP or lidar.SILENT"
    )
    open_error_names(names)
    add_shelving_time(parser)
    parser.add_argument("--reason", help="why; needed, except with --end")
    parser.add_argument("--end", action="store_true", help="announce them again")
    add_format(parser, "json: the errors")
    add_url(parser)


def _run(options: argparse.Namespace) -> int:
    if not (options.end or options.reason):
        options.parser.error('say why, as in --reason "it is being cleaned"')

    def ask(client: "ServiceClient") -> Outcome:
        if options.end:
            return _end(client, options.names, options.format)
        return _shelve(client, options.names, options.for_s, options.reason, options.format)

    return with_service(options.url, ask)


COMMAND = Command("shelve", _ABOUT, _TEXT, _add_options, _run)


def _shelve(
    client: "ServiceClient", names: list[str], for_s: float, reason: str, how: str
) -> Outcome:
    done = []
    for name in names:
        done.append(shelve(client, name, for_s, reason))
        if how == "text":
            say(f"{name} is not announced until {done[-1]['shelved_until_at']}")
    if how == "json":
        say_json({"items": done})
    return Outcome.SUCCEEDED


def _end(client: "ServiceClient", names: list[str], how: str) -> Outcome:
    for name in names:
        unshelve(client, name)
        if how == "text":
            say(f"{name} is announced again")
    if how == "json":
        say_json({"announced": names})
    return Outcome.SUCCEEDED
