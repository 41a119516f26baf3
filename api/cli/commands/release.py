"""`pilothouse release`: release the emergency stop, or holds."""

import argparse
from typing import TYPE_CHECKING
from urllib.parse import quote

from api.cli.commands.command import Command, add_format, add_url, say_json, with_service
from api.cli.completers import hold_owners
from api.cli.hold_lines import hold_line
from api.cli.unknown_name import no_such
from api.client.outcomes import Json, Outcome
from api.terminal_text import say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_ABOUT = "release the emergency stop, or holds"
_TEXT = """\
Release the emergency stop; with owners, release their holds instead. Then tell
what still holds the task. A task that nothing holds drives on.

The holds `error` and `vehicle` end with their cause, and a hardware stop is
released at its button.

  pilothouse release                       the emergency stop
  pilothouse release operator              the hold of this owner
  pilothouse hold --list                   which holds are there?

exit code: 0 released, or it was not engaged;
           1 rejected, or there is no such hold; 2 no answer
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    owners = parser.add_argument(
        "owners", metavar="OWNER", nargs="*", help="release the hold of this owner"
    )
    hold_owners(owners)
    parser.add_argument("--reason", help="why the emergency stop is released")
    parser.add_argument(
        "--volatile",
        action="store_true",
        help="release though storage fails, so that a restart may forget it",
    )
    add_format(parser, "json: {emergency_stop, holds}")
    add_url(parser)


def _run(options: argparse.Namespace) -> int:
    if options.owners and options.reason:
        options.parser.error("--reason is for the emergency stop; a hold is released without one")

    def ask(client: "ServiceClient") -> Outcome:
        before = client.call("GET", "/emergency_stop")
        if options.owners:
            told = _release_holds(client, options.owners, is_volatile=options.volatile)
        else:
            told = _release_stop(client, options.reason, before, is_volatile=options.volatile)
        return _say_rest(client, told, options.format)

    return with_service(options.url, ask)


COMMAND = Command("release", _ABOUT, _TEXT, _add_options, _run)


def _release_stop(
    client: "ServiceClient", reason: str | None, before: Json, *, is_volatile: bool
) -> list[str]:
    body = {"engaged": False, "reason": reason, "volatile": is_volatile}
    client.call("PUT", "/emergency_stop", body)
    return [f"the emergency stop {'is released' if before['engaged'] else 'was not engaged'}"]


def _release_holds(client: "ServiceClient", owners: list[str], *, is_volatile: bool) -> list[str]:
    known = [str(hold["owner"]) for hold in client.call("GET", "/holds")["items"]]
    for owner in owners:
        if owner not in known:
            raise no_such("hold of owner", owner, known)
    for owner in owners:
        query = {"volatile": "true"} if is_volatile else None
        client.call("DELETE", f"/holds/{quote(owner, safe='')}", query=query)
    return [f"the hold of {owner} is released" for owner in owners]


def _say_rest(client: "ServiceClient", told: list[str], how: str) -> Outcome:
    """Say what was done, and what still keeps the vehicle from driving."""
    latch, holds = client.call("GET", "/emergency_stop"), client.call("GET", "/holds")["items"]
    if how == "json":
        say_json({"emergency_stop": latch, "holds": holds})
        return Outcome.SUCCEEDED
    for line in told:
        say(line)
    if latch["engaged"]:
        say(f"the emergency stop is engaged: {latch['reason'] or 'no reason given'}")
    for hold in holds:
        say(f"still {hold_line(hold)}")
    return Outcome.SUCCEEDED
