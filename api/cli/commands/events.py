"""`pilothouse events`: what happened, and with --follow what happens."""

import argparse
import json
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING, Literal

from api.cli.commands.command import Command, add_format, add_url, span, with_service
from api.cli.completers import part_names
from api.client.outcomes import Json, NoAnswerError, Outcome
from api.terminal_text import complain, say

if TYPE_CHECKING:
    from api.client.service_client import ServiceClient

_POLL_S = 0.25
_RETRY_S = 1.0
_MOST = 1_000

_ABOUT = "list what happened, or follow it"
_TEXT = """\
List the newest events, one a line: time, id, kind, words, and who asked for it.
With --follow, go on with what happens, until Ctrl-C. If the connection is lost,
that is said, and nothing is left out afterwards; what cannot be had any more is
said as well.

  pilothouse events --limit 100
  pilothouse events --since 10min --kind 'error.*'
  pilothouse events --part drive_base --follow
  pilothouse events --follow --format json | jq -r .words

exit code: 0 listed, or --follow was ended by Ctrl-C; 1 rejected; 2 no answer
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-f", "--follow", action="store_true", help="go on with what happens")
    parser.add_argument(
        "--limit",
        type=_limit,
        default=20,
        metavar="N",
        help=f"most events to begin with, 1 to {_MOST}; default: %(default)s",
    )
    parser.add_argument(
        "--since", type=span, metavar="TIME", help="only since so long ago, such as 90s or 10min"
    )
    parser.add_argument(
        "--kind", help="a kind such as change.failed, all of an area: change, or with *: *.failed"
    )
    part_names(parser.add_argument("--part", help="only events that name this system or node"))
    parser.add_argument("--actor", help="only what was asked for by this person or program")
    add_format(parser, "json: one object per line, as in GET /events")
    add_url(parser)


def _limit(text: str) -> int:
    number = int(text)
    if not 1 <= number <= _MOST:
        raise argparse.ArgumentTypeError(f"invalid number {number}; expected 1 to {_MOST}")
    return number


def _run(options: argparse.Namespace) -> int:
    wanted = {
        name: value
        for name in ("kind", "part", "actor")
        if (value := getattr(options, name)) is not None
    }
    begin: dict[str, str | int] = {**wanted, "limit": options.limit}
    if options.since is not None:
        since = datetime.now(UTC) - timedelta(seconds=options.since)
        begin["from_at"] = since.isoformat(timespec="milliseconds")

    def ask(client: "ServiceClient") -> Outcome:
        tell = _teller(options.format)
        found = client.call("GET", "/events", query=begin)
        for event in found["items"]:
            tell(event)
        if options.follow:
            with suppress(KeyboardInterrupt):
                follow(client, wanted, found, tell)
        return Outcome.SUCCEEDED

    return with_service(options.url, ask)


COMMAND = Command("events", _ABOUT, _TEXT, _add_options, _run)


def follow(
    client: "ServiceClient",
    wanted: Mapping[str, str],
    found: Json,
    tell: Callable[[Json], None],
    pause: Callable[[float], None] = time.sleep,
) -> None:
    """Tell events as they happen, until Ctrl-C.

    Args:
        client: The service.
        wanted: Filters of `GET /events`.
        found: The answer of `GET /events` to go on from.
        tell: Prints an event.
        pause: Waits for a number of seconds.

    Raises:
        ServiceProblemError: The request was rejected.
        KeyboardInterrupt: It was ended.
    """
    place = _Place(found)
    is_lost = False
    while True:
        try:
            answer = client.call("GET", "/events", query={**wanted, **place.query()})
        except NoAnswerError as error:
            if not is_lost:
                complain(f"{error}; trying again")
            is_lost = True
            pause(_RETRY_S)
            continue
        if is_lost:
            complain("connected again")
            is_lost = False
        for gap in _words_of_gaps(answer["gaps"]):
            complain(gap)
        for event in answer["items"]:
            tell(event)
        place.move(answer)
        if len(answer["items"]) < _MOST:
            pause(_POLL_S)


class _Place:
    """Up to where events were told."""

    def __init__(self, found: Json) -> None:
        self._after = int(found["newest"])
        self._epoch = str(found["epoch"])
        self._seen = self._after
        """Newest event of the last answer: whatever a filter left out of it is not asked again."""

    def query(self) -> dict[str, str | int]:
        """Return the query for what follows."""
        return {"after": self._after, "epoch": self._epoch, "limit": _MOST}

    def move(self, answer: Json) -> None:
        """Go on behind an answer."""
        if any(gap["to"] is None for gap in answer["gaps"]):
            # Of a run that the service does not know: it begins anew.
            self._after = self._seen = 0
        self._epoch = str(answer["epoch"])
        items = answer["items"]
        if items:
            self._after = int(items[-1]["id"])
        if len(items) < _MOST:
            self._after = max(self._after, self._seen)
        self._seen = int(answer["newest"])


def _words_of_gaps(gaps: list[Json]) -> Iterator[str]:
    for gap in gaps:
        if gap["to"] is None:
            yield "the service was restarted, and does not keep what happened before"
        else:
            yield f"events {gap['from']} to {gap['to']} are not kept"


def _teller(how: Literal["text", "json"]) -> Callable[[Json], None]:
    if how == "json":
        return lambda event: say(json.dumps(event))
    return lambda event: say(_line(event))


def _line(event: Json) -> str:
    actor = f"  [{event['actor']}]" if event["actor"] else ""
    return f"{event['at']}  {event['id']:>6}  {event['kind']:<22}  {event['words']}{actor}"
