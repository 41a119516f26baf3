"""What a shell offers for names that only the service knows; nothing, if it does not answer.

A shell asks while somebody types, so there is one short request for each kind of name.
"""

import argparse
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any

from api.client.outcomes import Json, NoAnswerError

if TYPE_CHECKING:
    from api.client.bare_request import Answer

_PATIENCE_S = 0.5

Ask = Callable[[str], "Answer"]
"""Sends a GET request for a path."""
_Names = Callable[[Ask, argparse.Namespace], Iterable[str]]


def part_names(action: argparse.Action) -> None:
    """Offer the systems and nodes."""
    _offer(action, _parts)


def mode_names(action: argparse.Action) -> None:
    """Offer the modes of the part that is named before."""
    _offer(action, _modes)


def signal_names(action: argparse.Action) -> None:
    """Offer the signals."""
    _offer(action, lambda ask, _: (item["signal"] for item in _items(ask("/signals"))))


def hold_owners(action: argparse.Action) -> None:
    """Offer the owners of holds."""
    _offer(action, lambda ask, _: (item["owner"] for item in _items(ask("/holds"))))


def open_error_names(action: argparse.Action) -> None:
    """Offer the errors that are not normal, or are shelved."""
    _offer(action, _errors)


def _parts(ask: Ask, _: argparse.Namespace) -> Iterator[str]:
    for kind in ("/systems", "/nodes"):
        yield from (item["name"] for item in _items(ask(kind)))


def _modes(ask: Ask, options: argparse.Namespace) -> Iterator[str]:
    from urllib.parse import quote

    part = quote(str(options.part).lstrip("/"))
    for kind in ("systems", "nodes"):
        yield from (item["mode"] for item in _items(ask(f"/{kind}/{part}/modes")))


def _errors(ask: Ask, _: argparse.Namespace) -> Iterator[str]:
    from api.cli.error_lines import error_name

    yield from map(error_name, _items(ask("/errors?open=true")))


def _items(answer: "Answer") -> list[Json]:
    return list(answer.body.get("items", ()))


def _offer(action: argparse.Action, names: _Names) -> None:
    """Let a shell offer names for an argument; the attribute is that of argcomplete."""

    def completer(parsed_args: argparse.Namespace, **_: Any) -> list[str]:  # noqa: ANN401
        from api.client.address import Address
        from api.client.bare_request import bare_request

        try:
            address = Address.with_token_of_environment(parsed_args.url)
            return list(
                names(lambda path: bare_request(address, "GET", path, _PATIENCE_S), parsed_args)
            )
        except NoAnswerError:
            return []

    setattr(action, "completer", completer)  # noqa: B010
