"""`pilothouse hold`: keep the vehicle from driving its task, until the hold is released."""

import argparse
from typing import TYPE_CHECKING
from urllib.parse import quote

from api.cli.commands.command import Command, add_format, add_url, say_json, with_service
from api.cli.hold_lines import hold_line
from api.client.outcomes import Outcome
from api.terminal_text import complain, say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

OPERATOR = "operator"
_LONGEST_REASON = 500
_ABOUT = "hold the task, until the hold is released"
_TEXT = """\
Hold the task: speed 0 is commanded at once, and the task goes on when there are
no more holds. Each owner has one hold; to set it again only changes its reason.
All other words are the reason.

  pilothouse hold lunch break
  pilothouse hold --owner loading the cart is being loaded
  pilothouse hold --list
  pilothouse release operator       release the hold of this owner

exit code: 0 the hold is set, or --list was answered; 1 rejected; 2 no answer
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("reason", metavar="REASON", nargs="*", help="why; any number of words")
    parser.add_argument(
        "--owner", default=OPERATOR, metavar="NAME", help="whose hold; default: %(default)s"
    )
    parser.add_argument("--list", action="store_true", help="list the holds, and set none")
    add_format(parser, "json: the hold, or {items} with --list")
    add_url(parser)


def _run(options: argparse.Namespace) -> int:
    def ask(client: "ServiceClient") -> Outcome:
        if options.list:
            return _list(client, options.format)
        return _hold(client, options.owner, " ".join(options.reason), options.format)

    return with_service(options.url, ask)


COMMAND = Command("hold", _ABOUT, _TEXT, _add_options, _run, words="reason")


def _hold(client: "ServiceClient", owner: str, reason: str, how: str) -> Outcome:
    body = {"reason": reason[:_LONGEST_REASON]}
    hold = client.call("PUT", f"/holds/{quote(owner, safe='')}", body)
    for fault in hold.get("ignored") or ():
        complain(f"ignored: {fault['message']}")
    if how == "json":
        say_json(hold)
    else:
        say(hold_line(hold))
        say(f"to release it: pilothouse release {owner}")
    return Outcome.SUCCEEDED


def _list(client: "ServiceClient", how: str) -> Outcome:
    holds = client.call("GET", "/holds")
    if how == "json":
        say_json(holds)
    else:
        for line in map(hold_line, holds["items"]) if holds["items"] else ("no holds",):
            say(line)
    return Outcome.SUCCEEDED
