"""`pilothouse why`: why a part is not where it should be, or what keeps it from a mode."""

import argparse
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from api.cli.commands.command import Command, add_format, add_url, with_service
from api.cli.completers import mode_names, part_names
from api.cli.hold_lines import hold_line
from api.cli.monitor.device_words import stop_places
from api.cli.unknown_name import no_such
from api.client.outcomes import Json, Outcome
from api.terminal_text import say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_ABOUT = "tell why the robot does not drive, or why a part deviates"
_TEXT = """\
Tell why the robot does not drive: its errors, and what holds it. With a system
or node, tell why that is not where it should be. With a mode as well, tell
whether a request for it would be accepted now, and what keeps the part from it.

Each reason stands above those that it follows from; a root cause has none
below.

  pilothouse why
  pilothouse why actuation
  pilothouse why actuation PERFORMANCE

exit code: 0 nothing keeps the robot from driving, the part is where it should
           be, or the mode can be entered;
           1 it is not so, or there is no such part or mode; 2 no answer
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    part = parser.add_argument("part", metavar="PART", nargs="?", help="name of a system or node")
    part_names(part)
    mode_names(parser.add_argument("mode", metavar="MODE", nargs="?", help="one of its modes"))
    add_format(parser, "json: what the text is made of")
    add_url(parser)


def _run(options: argparse.Namespace) -> int:
    def ask(client: "ServiceClient") -> Outcome:
        if options.part is None:
            return why_robot(client, options.format, say)
        if options.mode is None:
            return why(client, options.part, options.format, say)
        return why_not(client, options.part, options.mode, options.format, say)

    return with_service(options.url, ask)


WHY = Command("why", _ABOUT, _TEXT, _add_options, _run)


def why_robot(client: "ServiceClient", how: str, say: Callable[[str], None]) -> Outcome:
    """Tell what keeps the robot from driving.

    Args:
        client: The service.
        how: `text` or `json`.
        say: Prints a line for the user.

    Raises:
        ServiceProblemError: The service denied access.
        NoAnswerError: The service did not answer.
    """
    state, holds = client.call("GET", "/system_state"), client.call("GET", "/holds")["items"]
    stop = client.call("GET", "/emergency_stop")
    is_free = not (state["reasons"] or holds or stop["engaged"])
    if how == "json":
        say(json.dumps({"system_state": state, "holds": holds, "emergency_stop": stop}))
    else:
        task = str(state["task_status"]).lower().replace("_", " ")
        say(f"the robot is {state['state']}, {task}{'; nothing keeps it' if is_free else ''}")
        if stop["engaged"]:
            where = f" {places}" if (places := stop_places(stop)) else ""
            say(f"  emergency stop{where} by {stop['by']}: {stop['reason'] or 'no reason given'}")
        for line in (*reason_lines(state["reasons"]), *(f"  {hold_line(hold)}" for hold in holds)):
            say(line)
    return Outcome.SUCCEEDED if is_free else Outcome.FAILED


def why(client: "ServiceClient", part: str, how: str, say: Callable[[str], None]) -> Outcome:
    """Tell why a part is not where it should be.

    Args:
        client: The service.
        part: System or node.
        how: `text` or `json`.
        say: Prints a line for the user.

    Raises:
        ServiceProblemError: There is no such part.
        NoAnswerError: The service did not answer.
    """
    found = client.call("GET", f"{client.path_of(part)}/why")
    is_there = found["converged"] and not found["blockers"]
    if how == "json":
        say(json.dumps(found))
    else:
        say(_where(part, found))
        for line in reason_lines(found["blockers"]):
            say(line)
    return Outcome.SUCCEEDED if is_there else Outcome.FAILED


def why_not(
    client: "ServiceClient", part: str, mode: str, how: str, say: Callable[[str], None]
) -> Outcome:
    """Tell what keeps a part from a mode.

    Args:
        client: The service.
        part: System or node.
        mode: One of its modes.
        how: `text` or `json`.
        say: Prints a line for the user.

    Raises:
        ServiceProblemError: There is no such part or mode.
        NoAnswerError: The service did not answer.
    """
    modes = client.call("GET", f"{client.path_of(part)}/modes")["items"]
    found = next((each for each in modes if each["mode"] == mode), None)
    if found is None:
        raise no_such(f"mode of {part}", mode, [each["mode"] for each in modes])
    if how == "json":
        say(json.dumps(found))
    else:
        say(f"{part} {'can' if found['can_enter'] else 'cannot'} enter {mode} now")
        for line in (*reason_lines(found["blockers"]), *_guard_lines(found)):
            say(line)
    return Outcome.SUCCEEDED if found["can_enter"] else Outcome.FAILED


# --- in words ------------------------------------------------------------------------------------


def reason_lines(blockers: Sequence[Json], depth: int = 1) -> Iterator[str]:
    """Yield a line for each reason, with those that it follows from indented below it."""
    for blocker in blockers:
        path = " > ".join(blocker["path"])
        where = f"  ({path})" if path and depth == 1 else ""
        only_shown = "" if blocker["refuses"] else "  [does not refuse]"
        yield f"{'  ' * depth}{blocker['code']}: {blocker['message']}{where}{only_shown}"
        yield from reason_lines(blocker["causes"], depth + 1)


def _where(part: str, found: Json) -> str:
    actual, target = found["actual"], found["effective_target"]
    here = f"{part} is {_label(actual)}"
    if target is None:
        return f"{here}; nothing was requested of it"
    because = "" if target["because"] == "requested" else f" ({target['because']})"
    if found["converged"]:
        return f"{here}, as its target says{because}"
    return f"{here}, target {_label(target)}{because}"


def _label(pair: Mapping[str, Any]) -> str:
    return f"{pair['state']}.{pair['mode']}" if pair["mode"] else str(pair["state"])


def _guard_lines(mode: Json) -> Iterator[str]:
    for kind in ("requires", "invariants"):
        if mode[kind]:
            yield f"  {kind}: {'; '.join(mode[kind])}"
