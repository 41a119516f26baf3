"""`pilothouse signal`: show signals, or submit the reading of one."""

import argparse
from collections.abc import Iterator, Sequence
from math import isfinite
from typing import TYPE_CHECKING
from urllib.parse import quote

from api.cli.commands.command import Command, add_format, add_url, say_json, with_service
from api.cli.completers import signal_names
from api.client.outcomes import Json, Outcome
from api.terminal_text import complain, say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_ABOUT = "show signals, or submit a reading"
_TEXT = """\
Show all signals or one of them; with a value, submit a reading, which is
evaluated at once, and show the state of the robot that follows.

A value is a number in the unit of the signal, true or false (also on, off, yes,
no), a share such as 42%, or a text. On a robot with real sensors, the next
reading of the sensor replaces it.

  pilothouse signal                         all signals
  pilothouse signal battery_level           one
  pilothouse signal battery_level 42%       submit a reading: 0.42
  pilothouse signal estop true

exit code: 0 shown, or accepted; 1 rejected, or there is no such signal;
           2 no answer
"""
_WORDS = {"true": True, "on": True, "yes": True, "false": False, "off": False, "no": False}


def _add_options(parser: argparse.ArgumentParser) -> None:
    name = parser.add_argument("name", metavar="NAME", nargs="?", help="name of a signal")
    signal_names(name)
    parser.add_argument(
        "value", metavar="VALUE", nargs="?", type=value_of, help="reading to submit"
    )
    parser.add_argument(
        "--source", metavar="NAME", help="who measured it; default: api, or mock where it runs"
    )
    add_format(parser, "json: {items}, the signal, or the state of the robot")
    add_url(parser)


def value_of(text: str) -> bool | int | float | str:
    """Read a value as it is typed."""
    if (word := _WORDS.get(text.lower())) is not None:
        return word
    try:
        return int(text)
    except ValueError:
        pass
    try:
        number = float(text[:-1]) / 100 if text.endswith("%") else float(text)
    except ValueError:
        return text
    # JSON has no others.
    return number if isfinite(number) else text


def _run(options: argparse.Namespace) -> int:
    def ask(client: "ServiceClient") -> Outcome:
        if options.name is None:
            return _list(client, options.format)
        if options.value is None:
            return _show(client, options.name, options.format)
        return _submit(client, options.name, options.value, options.source, options.format)

    return with_service(options.url, ask)


COMMAND = Command("signal", _ABOUT, _TEXT, _add_options, _run)


def _list(client: "ServiceClient", how: str) -> Outcome:
    found = client.call("GET", "/signals")
    if how == "json":
        say_json(found)
    else:
        for line in signal_lines(found["items"]) if found["items"] else ("no signals",):
            say(line)
    return Outcome.SUCCEEDED


def _show(client: "ServiceClient", name: str, how: str) -> Outcome:
    found = client.call("GET", f"/signals/{quote(name)}")
    if how == "json":
        say_json(found)
    else:
        for line in signal_lines([found]):
            say(line)
    return Outcome.SUCCEEDED


def _submit(
    client: "ServiceClient", name: str, value: object, source: str | None, how: str
) -> Outcome:
    body = {"value": value, **({} if source is None else {"source": source})}
    state = client.call("POST", f"/signals/{quote(name)}", body)
    for fault in state.get("ignored") or ():
        complain(f"ignored: {fault['message']}")
    if how == "json":
        say_json(state)
    else:
        _show(client, name, how)
        errors = f": {', '.join(state['errors'])}" if state["errors"] else ""
        say(f"the robot is {state['state']}{errors}")
    return Outcome.SUCCEEDED


def signal_lines(items: Sequence[Json]) -> Iterator[str]:
    """Yield a line for each signal, in columns: value, age, and whether it is well."""
    from api.cli.monitor.words import duration, value_words, verdict_words

    rows = [
        (
            str(item["signal"]),
            value_words(item),
            "never" if item["age_s"] is None else f"{duration(item['age_s'])} ago",
            verdict_words(item, item["pending"] and item["pending"]["for_s"]),
        )
        for item in items
    ]
    widths = [max(len(row[column]) for row in rows) for column in range(3)]
    for row in rows:
        cells = [text.ljust(width) for text, width in zip(row, widths, strict=False)]
        yield "  ".join([*cells, row[3]]).rstrip()
