"""`pilothouse mode` and `pilothouse state`: request a change, and follow it to its end."""

import argparse
import math
import time
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from api.cli.commands.command import Command, add_url, with_service
from api.client.outcomes import Json, Outcome

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_TRANSITIONS = ("configure", "activate", "deactivate", "cleanup", "shutdown")
_MAX_WAIT_S = 3600.0
_POLL_S = 0.1

_ABOUT_MODE = "change the mode of a system or node"
_ABOUT_STATE = "request a lifecycle transition of a system or node"
_CODES = """\
exit code: 0 succeeded; 1 rejected or failed;
           2 unknown: timed out, or no answer
"""

# --- the command line ----------------------------------------------------------------------------


def _add_mode_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("part", metavar="PART", help="name of a system or node")
    parser.add_argument("mode", metavar="MODE", help="name of one of its modes")
    _add_change_options(parser)


def _add_state_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("part", metavar="PART", help="name of a system or node")
    parser.add_argument(
        "transition", metavar="TRANSITION", choices=_TRANSITIONS, help=", ".join(_TRANSITIONS)
    )
    _add_change_options(parser)


def _add_change_options(parser: argparse.ArgumentParser) -> None:
    add_url(parser)
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
            return show_plan(client, options.part, what, request, print)
        return change(client, options.part, what, request, options.wait, print)

    return with_service(options.url, ask)


MODE = Command(
    "mode",
    _ABOUT_MODE,
    f"{_ABOUT_MODE.capitalize()}.\n\n{_CODES}",
    _add_mode_options,
    _run_mode,
)
STATE = Command(
    "state",
    _ABOUT_STATE,
    f"{_ABOUT_STATE.capitalize()}.\n\n{_CODES}",
    _add_state_options,
    _run_state,
)

# --- what they do --------------------------------------------------------------------------------


def show_plan(
    client: "ServiceClient", part: str, what: str, request: Json, say: Callable[[str], None]
) -> Outcome:
    """Show the steps that a change would take; nothing is changed.

    Args:
        client: The service.
        part: System or node.
        what: `mode` or `state`.
        request: Body of the request.
        say: Prints a line for the user.

    Raises:
        ServiceProblemError: The request would be rejected.
        NoAnswerError: The service did not answer.
    """
    plan = client.call("POST", f"{client.path_of(part)}/{what}?dry_run=true", request)
    steps = plan["steps"]
    if not steps:
        say(f"{part} is there already: no step is needed")
    for step in sorted(steps, key=lambda step: int(step["stage"])):
        stage = f"stage {step['stage']}: " if plan["stages"] > 1 else ""
        say(f"{stage}would {_words(step['action'])} {step['node']}")
    if steps and plan["expected_s"] is not None:
        say(f"takes about {plan['expected_s']:.3g} s")
    return Outcome.SUCCEEDED


def change(
    client: "ServiceClient",
    part: str,
    what: str,
    request: Json,
    wait_s: float,
    say: Callable[[str], None],
    pause: Callable[[float], None] = time.sleep,
) -> Outcome:
    """Request a change, and report its steps until it ends.

    Args:
        client: The service.
        part: System or node.
        what: `mode` or `state`.
        request: Body of the request.
        wait_s: Longest time to wait for the end, in seconds.
        say: Prints a line for the user.
        pause: Waits for a number of seconds.

    Raises:
        ServiceProblemError: The request was rejected.
        NoAnswerError: The service did not answer; the outcome is unknown.
    """
    view = client.call("POST", f"{client.path_of(part)}/{what}", request)
    told: dict[tuple[str, int], str] = {}
    deadline = time.monotonic() + wait_s
    if view["status"] == "waiting":
        say(f"waits: {view['reason']}")
    while True:
        for line in _news(view["steps"], told):
            say(line)
        if view["status"] not in ("running", "waiting"):
            break
        if time.monotonic() >= deadline:
            say(f"not ended within {wait_s:g} s; see {client.address.url}/changes/{view['id']}")
            return Outcome.UNKNOWN
        pause(_POLL_S)
        view = client.call("GET", f"/changes/{view['id']}")
    say(f"{part}: {_words(view['status'])}" + (f": {view['reason']}" if view["reason"] else ""))
    ends = {"succeeded": Outcome.SUCCEEDED, "timed_out": Outcome.UNKNOWN}
    return ends.get(view["status"], Outcome.FAILED)


def _news(steps: Sequence[Json], told: dict[tuple[str, int], str]) -> Iterator[str]:
    """Yield a line for each step that changed; the steps of a node keep their order."""
    seen: dict[str, int] = {}
    for step in steps:
        number = seen[step["node"]] = seen.get(step["node"], 0) + 1
        key, status = (step["node"], number), step["status"]
        if status == "pending" or told.get(key) == status:
            continue
        told[key] = status
        error = f": {step['error']}" if step["error"] else ""
        ending = "..." if status == "running" else f": {_words(status)}{error}"
        yield f"{_words(step['action'])} {step['node']}{ending}"


def _words(label: str) -> str:
    return label.replace("_", " ")
