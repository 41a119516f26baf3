"""`pilothouse devices`: the other computers of the robot, what they own, whether they are heard."""

import argparse
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from api.cli.commands.command import Command, add_format, add_url, with_service
from api.cli.monitor.device_words import own_words, state_words
from api.client.outcomes import Outcome
from api.terminal_text import say, visible

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

Json: TypeAlias = Mapping[str, Any]

_ABOUT = "list the other computers of the robot"
_TEXT = """\
List the devices of a robot of several computers: whether each is heard, what it
owns, what it does by itself when it is cut off, and the emergency stops that
are engaged on it. Of a device itself: whose word counts there.

exit code: 0 all devices are connected, or there is none; 1 one is not;
           2 no answer
"""
_TITLES = ("device", "state", "heard", "parts", "when cut off", "stops")


def _add_options(parser: argparse.ArgumentParser) -> None:
    add_format(parser, "json: {items}, of a device {items, this}")
    add_url(parser)


def _run(options: argparse.Namespace) -> int:
    def ask(client: "ServiceClient") -> Outcome:
        return list_devices(client.call("GET", "/devices"), options.format, say)

    return with_service(options.url, ask)


COMMAND = Command("devices", _ABOUT, _TEXT, _add_options, _run)


def list_devices(answer: Json, how: str, say: Callable[[str], None]) -> Outcome:
    """List devices; return whether all are connected.

    Args:
        answer: To `GET /devices`.
        how: `text` or `json`.
        say: Prints a line for the user.
    """
    items, this = answer["items"], answer.get("this")
    if how == "json":
        say(json.dumps(answer))
    else:
        for line in _lines(items, this):
            say(line)
    is_cut_off = this is not None and this["lead"] != "supervisor"
    is_whole = all(item["state"] == "connected" for item in items) and not is_cut_off
    return Outcome.SUCCEEDED if is_whole else Outcome.FAILED


def _lines(items: Sequence[Json], this: Json | None) -> Iterator[str]:
    if this is not None:
        why = f" ({this['reason']})" if this["reason"] else ""
        yield visible(f"{own_words(this)}{why}")
        yield visible(f"when cut off: {this['when_cut_off']}")
        return
    if not items:
        yield "no devices: the robot has one computer"
        return
    rows = [_TITLES, *map(_row, items)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(_TITLES))]
    for row, item in zip(rows, (None, *items), strict=True):
        cells = (text.ljust(width) for text, width in zip(row, widths, strict=True))
        yield "  ".join(cells).rstrip()
        if item is not None and item["reason"]:
            yield f"  {visible(item['reason'])}"


def _row(item: Json) -> tuple[str, ...]:
    state = state_words(item)
    return (
        visible(item["device"]),
        f"{state}, acts alone" if item["autonomous"] else state,
        _heard(item["heard_age_s"]),
        visible(", ".join(item["parts"])),
        visible(_offline(item["offline"])),
        visible(", ".join(item["stops"])) or "none",
    )


def _heard(age_s: float | None) -> str:
    if age_s is None:
        return "never"
    return "now" if age_s < 1 else f"{age_s:.0f} s ago"


def _offline(offline: Json) -> str:
    """Return what a device does by itself, such as "after 2 s: drive_base to inactive"."""
    wanted = [f"{part} to {label}" for part, label in offline["target"].items()]
    if offline["reactions"]:
        wanted.append("its reactions act")
    return f"after {offline['after_s']:g} s: {', '.join(wanted)}" if wanted else "stays as it is"
