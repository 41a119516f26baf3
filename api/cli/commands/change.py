"""`pilothouse mode` and `pilothouse state`: request a change, and follow it to its end."""

import argparse
import json
import math
import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from api.cli.change_report import JsonReport, Report, TextReport, is_large, words_of
from api.cli.commands.command import Command, add_format, add_url, with_service
from api.cli.completers import mode_names, part_names
from api.cli.terminal_line import TerminalLine
from api.client.outcomes import Json, Outcome
from api.terminal_text import say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_TRANSITIONS = ("configure", "activate", "deactivate", "cleanup", "shutdown")
_MAX_WAIT_S = 3600.0
_POLL_S = 0.1
_POLL_LARGE_S = 0.5
"""Its answer has a step for each node."""

_ABOUT_MODE = "change the mode of a system or node"
_ABOUT_STATE = "request a lifecycle transition of a system or node"
_MANY = """\
The steps are told as they happen; of more than 20 nodes, how many have arrived.

"""
_MODE_EXAMPLES = """\
  pilothouse mode actuation PERFORMANCE
  pilothouse mode actuation PERFORMANCE --dry-run     show the steps only
  pilothouse mode arm FAST --wait-for 30              wait for what it requires

"""
_STATE_EXAMPLES = """\
  pilothouse state drive_base deactivate
  pilothouse state actuation activate --wait 10

"""
_CODES = """\
exit code: 0 succeeded; 1 rejected or failed;
           2 unknown: timed out, or no answer
"""

# --- the command line ----------------------------------------------------------------------------


def _add_mode_options(parser: argparse.ArgumentParser) -> None:
    _add_part(parser)
    mode_names(parser.add_argument("mode", metavar="MODE", help="name of one of its modes"))
    _add_change_options(parser)


def _add_state_options(parser: argparse.ArgumentParser) -> None:
    _add_part(parser)
    parser.add_argument(
        "transition", metavar="TRANSITION", choices=_TRANSITIONS, help=", ".join(_TRANSITIONS)
    )
    _add_change_options(parser)


def _add_part(parser: argparse.ArgumentParser) -> None:
    part_names(parser.add_argument("part", metavar="PART", help="name of a system or node"))


def _add_change_options(parser: argparse.ArgumentParser) -> None:
    add_url(parser)
    add_format(parser, "json: the change as it ended, or the plan")
    parser.add_argument(
        "--wait",
        default=60.0,
        type=_wait_s,
        metavar="S",
        help="seconds to wait for the end; default: %(default)g",
    )
    parser.add_argument(
        "--wait-for",
        type=_wait_s,
        metavar="S",
        help="let the request wait so many seconds for what its modes require; default: it is"
        " rejected then",
    )
    parser.add_argument("--dry-run", action="store_true", help="show the steps, change nothing")


def _wait_s(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not 0 <= number <= _MAX_WAIT_S:
        raise argparse.ArgumentTypeError(f"{text!r} is not within 0 to {_MAX_WAIT_S:g} seconds")
    return number


def _run_mode(options: argparse.Namespace) -> int:
    return _run(options, "mode", {"mode": options.mode})


def _run_state(options: argparse.Namespace) -> int:
    return _run(options, "state", {"transition": options.transition})


def _run(options: argparse.Namespace, what: str, request: dict[str, str | float]) -> int:
    if options.wait_for is not None:
        request["wait_for_s"] = options.wait_for

    def ask(client: "ServiceClient") -> Outcome:
        if options.dry_run:
            return show_plan(client, options.part, what, request, options.format, say)
        with TerminalLine(sys.stderr) as line:
            report = JsonReport(say) if options.format == "json" else TextReport(say, line)
            return change(client, options.part, what, request, options.wait, report)

    return with_service(options.url, ask)


MODE = Command(
    "mode",
    _ABOUT_MODE,
    f"{_ABOUT_MODE.capitalize()}.\n{_MANY}{_MODE_EXAMPLES}{_CODES}",
    _add_mode_options,
    _run_mode,
)
STATE = Command(
    "state",
    _ABOUT_STATE,
    f"{_ABOUT_STATE.capitalize()}.\n{_MANY}{_STATE_EXAMPLES}{_CODES}",
    _add_state_options,
    _run_state,
)

# --- what they do --------------------------------------------------------------------------------


def show_plan(
    client: "ServiceClient",
    part: str,
    what: str,
    request: Json,
    how: str,
    say: Callable[[str], None],
) -> Outcome:
    """Show the steps that a change would take; nothing is changed.

    Args:
        client: The service.
        part: System or node.
        what: `mode` or `state`.
        request: Body of the request.
        how: `text` or `json`.
        say: Prints a line for the user.

    Raises:
        ServiceProblemError: The request would be rejected.
        NoAnswerError: The service did not answer.
    """
    plan = client.call("POST", f"{client.path_of(part)}/{what}?dry_run=true", request)
    steps = plan["steps"]
    if how == "json":
        say(json.dumps(plan))
        return Outcome.SUCCEEDED
    if not steps:
        say(f"{part} is there already: no step is needed")
    for step in sorted(steps, key=lambda step: int(step["stage"])):
        stage = f"stage {step['stage']}: " if plan["stages"] > 1 else ""
        say(f"{stage}would {words_of(step['action'])} {step['node']}")
    if steps and plan["expected_s"] is not None:
        say(f"takes about {plan['expected_s']:.3g} s")
    return Outcome.SUCCEEDED


def change(
    client: "ServiceClient",
    part: str,
    what: str,
    request: Json,
    wait_s: float,
    report: Report,
    pause: Callable[[float], None] = time.sleep,
) -> Outcome:
    """Request a change, and report on it until it ends.

    Args:
        client: The service.
        part: System or node.
        what: `mode` or `state`.
        request: Body of the request.
        wait_s: Longest time to wait for the end, in seconds.
        report: Tells how it goes on.
        pause: Waits for a number of seconds.

    Raises:
        ServiceProblemError: The request was rejected.
        NoAnswerError: The service did not answer; the outcome is unknown.
    """
    path = client.path_of(part)
    view = client.call("POST", f"{path}/{what}", request)
    deadline = time.monotonic() + wait_s
    while True:
        report.show(view)
        if view["status"] not in ("running", "waiting"):
            break
        if time.monotonic() >= deadline:
            where = f"{client.address.url}/changes/{view['id']}"
            report.give_up(view, f"not ended within {wait_s:g} s; see {where}")
            return Outcome.UNKNOWN
        pause(_POLL_LARGE_S if is_large(view) else _POLL_S)
        view = client.call("GET", f"/changes/{view['id']}")
    report.end(part, view, _actual(client, path) if is_large(view) else "")
    ends = {"succeeded": Outcome.SUCCEEDED, "timed_out": Outcome.UNKNOWN}
    return ends.get(view["status"], Outcome.FAILED)


def _actual(client: "ServiceClient", path: str) -> str:
    """Return actual state and mode of a part, such as `active.FAST`."""
    actual = client.call("GET", path)["actual"]
    return ".".join(filter(None, (actual["state"], actual["mode"])))
