"""Delivers a stop to a service: tries again and again, over a new connection each time.

A try that hangs is left to itself, in a thread, and another one is begun: to engage the stop twice
changes nothing, and the first answer counts. So neither a lost packet nor a slow name server holds
up the next try, and the deadline is kept.
"""

import queue
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from http import HTTPStatus

from api.client.bare_request import Answer
from api.client.outcomes import NoAnswerError, NoConnectionError

HANGS_S = 1.5
"""A try without an answer for this time is left, and the next one begins."""
_PAUSES_S = (0.25, 0.5)
"""After the first try, and after each later one."""
_REFUSALS = frozenset({HTTPStatus.UNAUTHORIZED, HTTPStatus.FORBIDDEN})
"""Another try would be answered alike."""

Send = Callable[[float], Answer]
"""Sends the request once, with a time limit in s.

Raises:
    NoAnswerError: There was no answer.
"""


@dataclass(frozen=True, slots=True)
class Delivery:
    """What became of a stop."""

    answer: Answer | None
    """That of the service that engaged it, or that rejected it; None: there was none."""
    tries: int
    took_s: float
    """From the first try to the end."""
    is_open: bool
    """Whether a try is without an answer, so that it may have been delivered all the same."""

    @property
    def is_engaged(self) -> bool:
        """Tell whether the service says that the stop is engaged."""
        return self.answer is not None and _engages(self.answer)


def deliver(
    send: Send,
    within_s: float,
    tell: Callable[[str], None],
    now: Callable[[], float] = time.monotonic,
    pause: Callable[[float], None] = time.sleep,
) -> Delivery:
    """Send a stop until it is engaged or rejected, or the time is over.

    Args:
        send: Sends it once.
        within_s: Time in which tries are begun, in s; 0: there is one.
        tell: Gets a line for each try that comes to nothing.
        now: Time that never jumps, in s.
        pause: Waits for a number of seconds.
    """
    results: queue.SimpleQueue[Answer | NoAnswerError] = queue.SimpleQueue()
    begin = now()
    deadline = begin + within_s
    tries = ended = 0
    while True:
        tries += 1
        limit_s = max(deadline - now(), HANGS_S)
        threading.Thread(target=_try, args=(send, limit_s, results), daemon=True).start()
        try:
            result = results.get(timeout=HANGS_S)
        except queue.Empty:
            why = f"no answer yet after {HANGS_S:g} s"
        else:
            ended += not _may_have_arrived(result)
            if isinstance(result, Answer) and (_engages(result) or result.status in _REFUSALS):
                return Delivery(result, tries, now() - begin, is_open=ended < tries)
            why = str(result) if isinstance(result, NoAnswerError) else _words(result)
        left_s = deadline - now()
        if left_s <= 0:
            tell(f"try {tries}: {why}")
            return Delivery(None, tries, now() - begin, is_open=ended < tries)
        tell(f"try {tries}: {why}; trying again")
        pause(min(_PAUSES_S[tries > 1], left_s))


def _may_have_arrived(result: Answer | NoAnswerError) -> bool:
    """Tell whether a try that came to nothing may have stopped the vehicle all the same."""
    return isinstance(result, NoAnswerError) and not isinstance(result, NoConnectionError)


def _try(send: Send, left_s: float, results: "queue.SimpleQueue[Answer | NoAnswerError]") -> None:
    try:
        results.put(send(left_s))
    except NoAnswerError as error:
        results.put(error)


def _engages(answer: Answer) -> bool:
    return answer.status == HTTPStatus.OK and answer.body.get("engaged") is True


def _words(answer: Answer) -> str:
    told = answer.body.get("detail") or answer.body.get("title")
    return f"the service answered {answer.status}" + (f": {told}" if told else "")
