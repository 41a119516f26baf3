"""`pilothouse release`: release the emergency stop, or holds."""

import argparse
from time import monotonic, sleep
from typing import TYPE_CHECKING
from urllib.parse import quote

from api.cli.commands.command import Command, add_format, add_url, say_json, with_service
from api.cli.completers import hold_owners
from api.cli.hold_lines import hold_line
from api.cli.monitor.device_words import stop_places
from api.cli.unknown_name import no_such
from api.client.outcomes import Json, Outcome
from api.terminal_text import say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_WAIT_S, _LOOK_S = 2.0, 0.1
"""How long other computers may take to release their stops, and how often that is looked at."""

_ABOUT = "release the emergency stop, or holds"
_TEXT = """\
Release the emergency stop; with owners, release their holds instead. Then tell
what still holds the task. A task that nothing holds drives on.

The holds `error` and `vehicle` end with their cause, and a hardware stop is
released at its button. Of a robot with several computers, the stops of all that
can be heard are released; the stop of another one is released there.

  pilothouse release                       the emergency stop
  pilothouse release operator              the hold of this owner
  pilothouse hold --list                   which holds are there?

exit code: 0 released, or it was not engaged;
           1 rejected, still engaged somewhere, or there is no such hold;
           2 no answer
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
        latch = _say_rest(client, told, options.format)
        is_left = latch["engaged"] and not options.owners
        return Outcome.FAILED if is_left else Outcome.SUCCEEDED

    return with_service(options.url, ask)


COMMAND = Command("release", _ABOUT, _TEXT, _add_options, _run)


def _release_stop(
    client: "ServiceClient", reason: str | None, before: Json, *, is_volatile: bool
) -> list[str]:
    """Release the stops that there were before, and wait until other computers say that they did.

    A stop that is engaged meanwhile is not released: nobody saw it.
    """
    body: dict[str, object] = {"engaged": False, "reason": reason, "volatile": is_volatile}
    # A service of an earlier release does not tell single stops.
    if "stops" in before:
        body["stops"] = [stop["id"] for stop in before["stops"]]
    latch, end = client.call("PUT", "/emergency_stop", body), monotonic() + _WAIT_S
    while latch.get("waits_for") and monotonic() < end:
        sleep(_LOOK_S)
        latch = client.call("GET", "/emergency_stop")
    if latch["engaged"]:
        return []
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


def _say_rest(client: "ServiceClient", told: list[str], how: str) -> Json:
    """Say what was done, and what still keeps the vehicle from driving; return the stop."""
    latch, holds = client.call("GET", "/emergency_stop"), client.call("GET", "/holds")["items"]
    if how == "json":
        say_json({"emergency_stop": latch, "holds": holds})
        return latch
    for line in told:
        say(line)
    if latch["engaged"]:
        where = f" {places}" if (places := stop_places(latch)) else ""
        say(f"the emergency stop is engaged{where}: {latch['reason'] or 'no reason given'}")
    for hold in holds:
        say(f"still {hold_line(hold)}")
    return latch
