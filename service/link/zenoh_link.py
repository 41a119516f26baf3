"""The link over zenoh, between peers without a broker; the only module that imports it.

What zenoh calls back, on threads of its own, only hands messages over: to declare or to publish
there would freeze the interpreter. What is sent goes out on the event loop's thread, which takes a
few microseconds, and 0.1 ms at most where a computer takes nothing; only what is long has a thread.
Nothing is sent again by us: what the connection does not carry is dropped and counted.
"""

import asyncio
import json
import logging
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial

import zenoh
from zenoh.handlers import Callback

from domain.computers import ComputerName
from service.call_thread import CallThread
from service.link.certificates import Certificates, check_certificates
from service.link.endpoints import Endpoints
from service.link.intake import Intake
from service.link.long_messages import LongMessages
from service.link.port import MAX_MESSAGE_BYTES, DeliverMessage, LinkCounts
from service.link.zenoh_settings import BEAT, MESSAGE, check_endpoints, configuration, key

_AGAIN_S = 1.0
"""Between two attempts to listen."""
_CLOSE_S = 3.0

_log = logging.getLogger(__name__)


class ZenohLink:
    """A `Link` over zenoh."""

    def __init__(
        self,
        name: ComputerName,
        others: Sequence[ComputerName],
        endpoints: Endpoints,
        certificates: Certificates | None = None,
        *,
        insecure: bool = False,
    ) -> None:
        """Prepare; nothing is opened before `run`.

        Args:
            name: Of this computer.
            others: All other computers of the robot.
            endpoints: Where it listens, and where it finds others.
            certificates: By which the computers know each other; None: by what they say.
            insecure: Whether to do without certificates in a network.

        Raises:
            InvalidValueError: Somebody else could speak on the link, or the certificates are not
                good.
        """
        check_endpoints(endpoints, certificates, insecure=insecure)
        if certificates is not None:
            check_certificates(certificates, name)
        self._name = name
        self._others = tuple(others)
        self._endpoints = endpoints
        self._configuration = configuration(name, others, endpoints, certificates)
        self._intake = Intake(others, time.monotonic)
        self._opened: zenoh.Session | None = None
        """Of the thread that opens and closes it."""
        self._session: _Session | None = None
        self._unsent = 0

    async def run(self, deliver: DeliverMessage) -> None:
        """Deliver messages until cancelled; a port that is not free is tried again for ever."""
        self._intake.open(deliver)
        thread = CallThread("zenoh")
        try:
            self._session = await self._open(thread)
            await asyncio.get_running_loop().create_future()
        finally:
            if self._session is not None:
                self._session.end()
            self._session = None
            self._intake.close()
            # Also what is being opened meanwhile. A process ends without it, too.
            await asyncio.wait((thread.run(self._close),), timeout=_CLOSE_S)
            thread.end()

    def send(self, to: ComputerName, message: bytes, *, may_be_lost: bool) -> None:
        """Send a message, and return at once."""
        if to not in self._others or len(message) > MAX_MESSAGE_BYTES:
            self._unsent += 1
        elif self._session is not None:
            self._unsent += not self._session.send(to, message, may_be_lost=may_be_lost)

    def counts(self) -> LinkCounts:
        """Return what was dropped since the link was made."""
        counts = self._intake.counts()
        return LinkCounts(counts.received, counts.unknown, self._unsent)

    async def _open(self, thread: CallThread) -> "_Session":
        told = ""
        while True:
            try:
                return await thread.run(self._open_session)
            except zenoh.ZError as error:
                if str(error) != told:
                    told = str(error)
                    listening = ", ".join(self._endpoints.listen)
                    _log.error("link: cannot listen at %s: %s", listening, error)
            await asyncio.sleep(_AGAIN_S)

    def _open_session(self) -> "_Session":
        configured = zenoh.Config.from_json5(json.dumps(self._configuration))
        self._opened = zenoh.open(configured)
        return _Session(self._opened, self._name, self._others, self._intake.take_in)

    def _close(self) -> None:
        opened, self._opened = self._opened, None
        if opened is not None:
            # Fails after 10 s where packets are lost; nothing is left to do then.
            with suppress(zenoh.ZError):
                opened.close()  # type: ignore[no-untyped-call]


class _Session:
    """An open session of zenoh."""

    def __init__(
        self,
        session: zenoh.Session,
        name: ComputerName,
        others: Sequence[ComputerName],
        take_in: Callable[..., None],
    ) -> None:
        self._session = session
        self._beats = {to: _declare(session, key(to, name, BEAT), BEAT) for to in others}
        self._messages = {to: _declare(session, key(to, name, MESSAGE), MESSAGE) for to in others}
        self._long = LongMessages(lambda to, message: _put(self._messages[to], message))
        for sender in others:
            for kind in (BEAT, MESSAGE):
                expected = key(name, sender, kind)
                take = partial(take_in, sender, may_be_lost=kind == BEAT)
                # Direct: with a thread in between, what waits for it would have no bound, and it
                # would keep the process from ending.
                handler = Callback(partial(_hand_over, expected, take), indirect=False)
                session.declare_subscriber(expected, handler)

    def send(self, to: ComputerName, message: bytes, *, may_be_lost: bool) -> bool:
        """Send a message; False: it was dropped."""
        if may_be_lost:
            return _put(self._beats[to], message)
        if self._long.concern(to, message):
            return self._long.send(to, message)
        return _put(self._messages[to], message)

    def end(self) -> None:
        """Let the thread for long messages end."""
        self._long.end()


def _put(publisher: zenoh.Publisher, message: bytes) -> bool:
    """Publish; False: the session is closed."""
    try:
        publisher.put(message)
    except zenoh.ZError:
        return False
    return True


def _declare(session: zenoh.Session, key_expression: str, kind: str) -> zenoh.Publisher:
    is_beat = kind == BEAT
    reliability = zenoh.Reliability
    return session.declare_publisher(
        key_expression,
        congestion_control=zenoh.CongestionControl.DROP,
        # Not express: each message would take a place of its own in a queue of few.
        express=False,
        priority=zenoh.Priority.REAL_TIME if is_beat else zenoh.Priority.DATA,
        reliability=reliability.BEST_EFFORT if is_beat else reliability.RELIABLE,
    )


def _hand_over(key_expression: str, take: Callable[[bytes], None], sample: zenoh.Sample) -> None:
    """Take a message in; called on a thread of zenoh.

    One whose key has a wildcard would count as one of every sender.
    """
    if str(sample.key_expr) == key_expression:
        take(sample.payload.to_bytes())
