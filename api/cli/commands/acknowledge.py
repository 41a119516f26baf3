"""`pilothouse ack`: tell the service that somebody has seen an error."""

import argparse
from typing import TYPE_CHECKING

from api.cli.commands.command import Command, add_format, add_url, say_json, with_service
from api.cli.completers import open_error_names
from api.cli.error_lines import error_lines, error_name
from api.cli.error_requests import acknowledge, open_errors
from api.client.outcomes import Json, Outcome
from api.terminal_text import say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_ABOUT = "acknowledge errors"
_TEXT = """\
Acknowledge errors: somebody has seen them. An error that latches ends only
after that, once its cause is gone as well. Without a name, list the errors that
wait for it.

  pilothouse ack                            which wait for it?
  pilothouse ack ESTOP lidar.SILENT
  pilothouse ack --all

exit code: 0 acknowledged, or without a name: none waits for it;
           1 rejected, or there is no such error, or some wait; 2 no answer
"""
_SEEN = frozenset({"normal", "pending", "acknowledged"})
"""States in which nobody has to acknowledge an error."""


def _add_options(parser: argparse.ArgumentParser) -> None:
    what = parser.add_mutually_exclusive_group()
    names = what.add_argument(
        "names", metavar="NAME", nargs="*", default=[], help="such as ESTOP or lidar.SILENT"
    )
    open_error_names(names)
    what.add_argument("--all", action="store_true", help="acknowledge all that wait for it")
    add_format(parser, "json: the errors that are not over")
    add_url(parser)


def _run(options: argparse.Namespace) -> int:
    return with_service(
        options.url, lambda client: _ack(client, options.names, options.format, is_all=options.all)
    )


COMMAND = Command("ack", _ABOUT, _TEXT, _add_options, _run)


def _ack(client: "ServiceClient", names: list[str], how: str, *, is_all: bool) -> Outcome:
    waiting = [] if names else _waiting(client)
    if not (names or is_all):
        if how == "json":
            say_json({"items": waiting})
        else:
            for line in error_lines(waiting) if waiting else ("no error waits for it",):
                say(line)
        return Outcome.FAILED if waiting else Outcome.SUCCEEDED
    wanted = names or [error_name(item) for item in waiting]
    for name in wanted:
        acknowledge(client, name)
    still = {error_name(item): item for item in open_errors(client)["items"]}
    if how == "json":
        say_json({"items": [still[name] for name in wanted if name in still]})
        return Outcome.SUCCEEDED
    for name in wanted:
        end = "ends with its cause" if name in still else "is over"
        say(f"{name} is acknowledged; it {end}")
    if not wanted:
        say("no error waits for it")
    return Outcome.SUCCEEDED


def _waiting(client: "ServiceClient") -> list[Json]:
    """Return the errors that somebody should acknowledge."""
    return [item for item in open_errors(client)["items"] if item["state"] not in _SEEN]
