"""`pilothouse stop`: engage the emergency stop, with the least that can work.

It loads no model, no stream and no library, goes past any proxy, tries again until a deadline, and
takes any words: a stop does not fail because of how it was typed.
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from http import HTTPStatus
from typing import TYPE_CHECKING

from api.cli.commands.command import Command, add_url, default_url, say_json
from api.cli.exit_codes import INTERRUPTED
from api.client.outcomes import Json, NoAnswerError, Outcome, refusal_lines, token_hint
from api.terminal_text import complain, say

if TYPE_CHECKING:
    from api.cli.standstill import Standstill
    from api.cli.stop_delivery import Delivery
    from api.client.address import Address
    from api.client.bare_request import Answer

RETRY_S, WAIT_S = 10.0, 10.0
_LONGEST_S = 3_600.0
_LONGEST_REASON = 500

_NOT_DELIVERED = "Not delivered. Use the hardware stop."
_NOT_KNOWN = "It is not known whether the stop was delivered. Use the hardware stop."

_THERE = "Use the hardware stop there."

_ABOUT = "stop the vehicle, and keep it stopped"
_TEXT = f"""\
Engage the emergency stop: speed 0 is commanded at once, and nothing drives
until `pilothouse release`. Then wait until the vehicle stands still, and tell
its speed meanwhile.

It is tried again until it is delivered, for {RETRY_S:g} s unless --retry says
otherwise; each try is told. It needs nothing but the network, and goes past any
proxy. All other words are the reason.

This is a software stop. It is not safety-rated, and replaces no hardware stop.

  pilothouse stop
  pilothouse stop dog on the track
  pilothouse stop --url http://robot.local:8000
  ssh robot pilothouse stop

exit code: 0 the stop is engaged, whether or not the vehicle stands still yet;
           1 rejected, as without a valid token;
           2 not delivered, or not known: use the hardware stop
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.usage = """\
pilothouse stop [REASON ...] [--url URL] [--retry S] [--wait S]
                       [--format FORMAT]"""
    parser.add_argument("reason", metavar="REASON", nargs="*", help="why; any number of words")
    add_url(parser, is_needed=False)
    # A value that is none does not keep the vehicle from being stopped.
    parser.add_argument(
        "--retry",
        metavar="S",
        nargs="?",
        type=partial(_seconds, RETRY_S),
        default=RETRY_S,
        help="seconds to try again until it is delivered; default: %(default)g",
    )
    parser.add_argument(
        "--wait",
        metavar="S",
        nargs="?",
        type=partial(_seconds, WAIT_S),
        default=WAIT_S,
        help="seconds to wait for the standstill; default: %(default)g",
    )
    parser.add_argument(
        "--format",
        metavar="FORMAT",
        nargs="?",
        default="text",
        help="text (default) or json: {delivered, tries, took_s, standstill, speed_mps,"
        " emergency_stop}",
    )


def _seconds(default: float, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        return default
    return number if 0 <= number <= _LONGEST_S else default


def _run(options: argparse.Namespace) -> int:
    from api.client.address import Address
    from api.client.bare_request import bare_request

    try:
        address = Address.with_token_of_environment(options.url or default_url())
    except NoAnswerError as error:
        complain(str(error))
        complain(_NOT_DELIVERED)
        return Outcome.UNKNOWN
    return stop(
        StopOptions(
            reason=" ".join(options.reason)[:_LONGEST_REASON],
            retry_s=RETRY_S if options.retry is None else options.retry,
            wait_s=WAIT_S if options.wait is None else options.wait,
            is_json=options.format == "json",
        ),
        address,
        partial(bare_request, address),
    )


COMMAND = Command("stop", _ABOUT, _TEXT, _add_options, _run, words="reason", is_urgent=True)


@dataclass(frozen=True, slots=True)
class StopOptions:
    """Options of a stop."""

    reason: str
    retry_s: float
    """Time in which tries are begun."""
    wait_s: float
    """Longest time to wait for the standstill."""
    is_json: bool


def stop(options: StopOptions, address: "Address", ask: Callable[..., "Answer"]) -> int:
    """Deliver a stop, and wait for the standstill; return the exit code.

    Args:
        options: Of the command.
        address: URL of the service, and the token.
        ask: Sends a request: method, path, time limit in s, body.
    """
    from api.cli.standstill import Standstill
    from api.cli.stop_delivery import deliver

    body = {"engaged": True, "reason": options.reason}
    try:
        delivery = deliver(
            lambda limit_s: ask("PUT", "/emergency_stop", limit_s, body), options.retry_s, complain
        )
    except KeyboardInterrupt:
        complain(_NOT_KNOWN)
        return INTERRUPTED
    if delivery.answer is None or not delivery.is_engaged:
        return _say_undelivered(delivery, options, address)
    if not options.is_json:
        say(f"stop engaged {delivery.took_s:.2f} s after it was asked for")
    if silent := delivery.answer.body.get("not_heard"):
        complain(f"{', '.join(silent)}: not heard, and not known to be stopped. {_THERE}")
    if delivery.answer.is_volatile:
        _say_volatile(ask)
    still = Standstill(ask, delivery.answer.body, is_quiet=options.is_json)
    try:
        still.wait(options.wait_s)
    except KeyboardInterrupt:
        complain("not waiting for the standstill; the stop stays engaged")
        return INTERRUPTED
    if options.is_json:
        say_json(_summary(delivery, still))
    else:
        say(still.words())
    return Outcome.SUCCEEDED if still.is_engaged else Outcome.FAILED


def _say_undelivered(delivery: "Delivery", options: StopOptions, address: "Address") -> int:
    """Say that a stop was not delivered, and what to do; return the exit code."""
    if delivery.answer is not None:
        problem = dict(delivery.answer.body)
        if delivery.answer.status == HTTPStatus.UNAUTHORIZED:
            problem["hint"] = token_hint(given=address.token is not None)
        for line in refusal_lines(problem):
            complain(line)
    is_open = delivery.is_open and delivery.answer is None
    complain(_NOT_KNOWN if is_open else _NOT_DELIVERED)
    if options.is_json:
        delivered = None if is_open else False
        say_json({"delivered": delivered, "tries": delivery.tries, "took_s": delivery.took_s})
    return Outcome.UNKNOWN if delivery.answer is None else Outcome.FAILED


def _say_volatile(ask: Callable[..., "Answer"]) -> None:
    """Say that a restart would forget the stop, unless the service is to store nothing."""
    from api.cli.standstill import LOOK_S

    try:
        why = ask("GET", "/storage", LOOK_S).body.get("reason")
    except NoAnswerError:
        return
    if why:
        complain(f"a restart of the service would forget this: {why}")


def _summary(delivery: "Delivery", still: "Standstill") -> Json:
    return {
        "delivered": True,
        "tries": delivery.tries,
        "took_s": round(delivery.took_s, 3),
        "standstill": still.is_still,
        "speed_mps": still.speed_mps,
        "emergency_stop": still.latch,
    }
