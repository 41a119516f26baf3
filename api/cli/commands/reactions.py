"""`pilothouse reactions`: what the robot does while something is so; arms and acknowledges it."""

import argparse
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from api.cli.commands.command import Command, add_format, add_url, with_service
from api.cli.unknown_name import no_such
from api.client.outcomes import Outcome
from api.terminal_text import say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

Json: TypeAlias = Mapping[str, Any]

_ABOUT = "list the reactions of the robot; arm and acknowledge them"
_TEXT = """\
List the reactions of all parts, with what each waits for. A reaction that is
passive tells when it would act, and does nothing.

Arming stays in force over restarts of the service.

exit code: 0 no reaction acts, or all that was asked for is done;
           1 a reaction acts, or something was rejected; 2 no answer
"""
_ARMS = ("active", "passive", "disarmed")
_IN_EFFECT = frozenset({"acting", "exhausted"})


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--arm",
        metavar="NAME=HOW",
        type=arming,
        action="append",
        default=[],
        help="let a reaction be active, passive or disarmed",
    )
    parser.add_argument("--reason", default="", help="why it is armed so")
    parser.add_argument(
        "--ack", metavar="NAME", action="append", default=[], help="acknowledge a reaction"
    )
    add_format(parser, "json: {items}")
    add_url(parser)


def arming(text: str) -> tuple[str, str]:
    """Read the name of a reaction, and how it is to be armed.

    Raises:
        ArgumentTypeError: It says no such thing.
    """
    name, _, how = text.rpartition("=")
    if not name or how not in _ARMS:
        known = ", ".join(_ARMS)
        raise argparse.ArgumentTypeError(f"invalid {text!r}; such as LIMP=passive; {known}")
    return name, how


def _run(options: argparse.Namespace) -> int:
    def ask(client: "ServiceClient") -> Outcome:
        items = client.call("GET", "/reactions")["items"]
        if not (options.arm or options.ack):
            return list_reactions(items, options.format, say)
        wanted = [name for name, _ in options.arm] + options.ack
        if unknown := [name for name in wanted if _path(client, items, name) is None]:
            raise no_such("reaction", unknown[0], [item["reaction"] for item in items])
        for name, how in options.arm:
            body = {"arm": how, "reason": options.reason}
            client.call("PATCH", str(_path(client, items, name)), body)
        for name in options.ack:
            client.call("POST", f"{_path(client, items, name)}/acknowledge")
        return Outcome.SUCCEEDED

    return with_service(options.url, ask)


COMMAND = Command("reactions", _ABOUT, _TEXT, _add_options, _run)


def list_reactions(items: Sequence[Json], how: str, say: Callable[[str], None]) -> Outcome:
    """List reactions; return whether none acts.

    Args:
        items: As in `GET /reactions`.
        how: `text` or `json`.
        say: Prints a line for the user.
    """
    if how == "json":
        say(json.dumps({"items": items}))
    else:
        for line in reaction_lines(items) if items else ("no reactions",):
            say(line)
    acts = any(item["state"] in _IN_EFFECT for item in items)
    return Outcome.FAILED if acts else Outcome.SUCCEEDED


def reaction_lines(items: Sequence[Json]) -> Iterator[str]:
    """Yield a line for each reaction, in columns."""
    rows = [
        (f"{item['part']}.{item['reaction']}", _state(item), _action(item), item["waits_for"])
        for item in items
    ]
    widths = [max(len(row[column]) for row in rows) for column in range(3)]
    for name, state, action, waits_for in rows:
        name, state, action = (
            text.ljust(width) for text, width in zip((name, state, action), widths, strict=True)
        )
        yield f"{name}  {state}  {action}  waits for {waits_for}"


def _state(item: Json) -> str:
    """Return how a reaction stands, and its arm where that does not show it."""
    shows_arm = item["arm"] == "active" or item["state"] == item["arm"]
    return str(item["state"]) if shows_arm else f"{item['state']} ({item['arm']})"


def _action(item: Json) -> str:
    target = item["target"]
    if target is None:
        return str(item["action"])
    label = ".".join(filter(None, (target["state"], target["mode"])))
    return f"{item['action']} {label}"


def _path(client: "ServiceClient", items: Sequence[Json], name: str) -> str | None:
    """Return the path of a reaction by its name, alone or behind its part; None: unknown."""
    for item in items:
        if name in (item["reaction"], f"{item['part']}.{item['reaction']}"):
            return f"{client.path_of(item['part'])}/reactions/{item['reaction']}"
    return None
